"""The one exception that means: the input is wrong, and here is what would be right; and the hint of what was meant."""

import difflib
from collections.abc import Iterable

LONGEST = 1_500
"""Characters of a message: the longest lists of choices have about a thousand."""


class InputError(ValueError):
    """Bad input from outside: a rig, a recording, a scenario or an argument.

    The message is one line that names what is wrong, where, and what would be right. The command line
    prints it without a traceback and ends with exit status 2.

    What is quoted from the input may be long, hold line breaks, or control characters that a terminal would obey:
    as text the message is one printable line of at most `LONGEST` characters, its middle left out if need be.
    """

    def __str__(self) -> str:
        """The message."""
        line = " ".join(super().__str__().split())
        if not line.isprintable():
            line = "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in line)
        if len(line) > LONGEST:
            half = LONGEST // 2 - 4
            line = f"{line[:half]} [...] {line[-half:]}"
        return line


class UninformativeError(InputError):
    """A recording as it should be that shows nothing of what is asked: a command or a signal without content."""


def meant(given: str, known: Iterable[str], most: int = 3, alike: float = 0.6) -> str:
    """What was perhaps meant, for a message: "did you mean valve or supply? ", or nothing.

    Args:
        given: a name that is not there.
        known: those that are.
        most: names that are told.
        alike: how much they must be, from 0 to 1.
    """
    near = difflib.get_close_matches(given, known, n=most, cutoff=alike)
    return f"did you mean {' or '.join(near)}? " if near else ""
