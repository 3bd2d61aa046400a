"""What a function is doing, in a terminal or a notebook; nothing elsewhere, so that scripts stay silent."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def telling(shown: bool, first: str) -> Iterator[Callable[[str], None]]:
    """A line that changes.

    Args:
        shown: whether to show it at all.
        first: until something else is told.

    Yields:
        A function to tell what is done next.
    """
    from rich.console import Console

    console = Console(stderr=True, highlight=False)
    if not shown or not (console.is_terminal or console.is_jupyter):
        yield lambda text: None
        return
    with console.status(first) as status:
        yield lambda text: status.update(f"{text} ...")
