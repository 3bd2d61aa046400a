"""Commands as a user enters them."""

import pytest

from hydrolek_drake.cli.app import run


@pytest.fixture
def printed(capsys):
    """A function: arguments of a command that succeeds -> what it prints."""

    def output(*arguments):
        assert run([str(argument) for argument in arguments]) == 0
        return capsys.readouterr().out

    return output
