"""The one exception that means: the input is wrong, and here is what would be right."""


class InputError(ValueError):
    """Bad input from outside: a rig, a recording, a scenario or an argument.

    The message is one line that names what is wrong, where, and what would be right. The command line
    prints it without a traceback and ends with exit status 2.
    """


class UninformativeError(InputError):
    """A recording as it should be that shows nothing of what is asked: a command or a signal without content."""
