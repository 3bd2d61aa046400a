"""What the outside relies on: every command takes `--seed`."""

import importlib
import inspect

import pytest

from hydrolek_drake.cli.app import COMMANDS


def _functions():
    for name, entry in COMMANDS.items():
        found = getattr(importlib.import_module(entry.module), entry.attribute)
        if inspect.isfunction(found):
            yield name, found
        else:
            for command in found.registered_commands:
                yield f"{name} {command.name or command.callback.__name__}", command.callback


@pytest.mark.parametrize(
    ("name", "function"), _functions(), ids=lambda each: each if isinstance(each, str) else ""
)
def test_every_command_takes_a_seed(name, function):
    assert "seed" in inspect.signature(function).parameters, name
