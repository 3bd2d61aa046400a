"""Where commands print to."""

from rich.console import Console

_WIDTH_OF_FILES = 200  # letters: what goes to a file or a pipe is searched line by line


def console() -> Console:
    """Standard output: as wide as the terminal, or wide enough for one row a line where there is none."""
    output = Console(highlight=False)
    if not output.is_terminal:
        output.width = _WIDTH_OF_FILES
    return output
