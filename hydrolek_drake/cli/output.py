"""Where commands print to."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from hydrolek_drake.cli.telling import Telling, kept_alive

_WIDTH_OF_FILES = 200  # letters: what goes to a file or a pipe is searched line by line
_TERMINAL_S = 1.0  # between what is told in a terminal
_LOG_S = 10.0  # and in a log


def console() -> Console:
    """Standard output: as wide as the terminal, or wide enough for one row a line where there is none."""
    output = Console(highlight=False)
    if not output.is_terminal:
        output.width = _WIDTH_OF_FILES
    return output


@contextmanager
def progress(first: str) -> Iterator[Telling]:
    """What a long command is doing, on standard error.

    In a terminal it is one line that changes, with the time since the beginning; elsewhere, as in a log, each step is a
    line of its own with that time, and how it stands is another one now and then.

    Args:
        first: shown in a terminal until something else is told, elsewhere only if it lasts.

    Yields:
        What is called with each step, and told by `more` how it stands.
    """
    shown = Console(stderr=True, highlight=False)
    begin = time.monotonic()

    def since() -> float:
        return time.monotonic() - begin

    if shown.is_terminal:
        with shown.status(escape(first)) as status:

            def update(text: str) -> None:
                status.update(f"{escape(text)} [dim]({since():.0f} s)[/dim]")

            with kept_alive(Telling(update, _TERMINAL_S, first=first), _TERMINAL_S) as telling:
                yield telling
    else:

        def line(text: str) -> None:
            shown.print(f"{since():7.1f} s  {text}", markup=False, soft_wrap=True)

        with kept_alive(Telling(line, _LOG_S, first=first), _LOG_S / 4) as telling:
            yield telling


def text_table(head: list[str], body: list[list[str]]) -> Table:
    """Rows of text as a table of the terminal."""
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    for i, title in enumerate(head):
        table.add_column(escape(title), justify="left" if i == 0 else "right")
    for row in body:
        table.add_row(*row)
    return table
