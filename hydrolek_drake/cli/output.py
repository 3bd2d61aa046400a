"""Where commands print to."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console

_WIDTH_OF_FILES = 200  # letters: what goes to a file or a pipe is searched line by line


def console() -> Console:
    """Standard output: as wide as the terminal, or wide enough for one row a line where there is none."""
    output = Console(highlight=False)
    if not output.is_terminal:
        output.width = _WIDTH_OF_FILES
    return output


@contextmanager
def progress(first: str) -> Iterator[Callable[[str], None]]:
    """What a long command is doing, on standard error.

    In a terminal it is one line that changes; elsewhere, as in a log, each text is a line of its own with the time
    since the beginning.

    Args:
        first: shown in a terminal until something else is told.

    Yields:
        A function to tell what is done next.
    """
    shown = Console(stderr=True, highlight=False)
    begin = time.monotonic()
    if shown.is_terminal:
        with shown.status(first) as status:
            yield lambda text: status.update(text)
    else:
        yield lambda text: shown.print(
            f"{time.monotonic() - begin:7.1f} s  {text}", markup=False, soft_wrap=True
        )
