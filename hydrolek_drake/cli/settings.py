"""Options that many commands take, such as `--set path=value`."""

from collections.abc import Iterable
from typing import Annotated

import typer

from hydrolek_drake.errors import InputError

SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="a parameter of the rig, in SI or with a unit: 'supply.pressure=12 MPa'",
    ),
]

SeedOption = Annotated[
    int | None, typer.Option(help="taken by all commands; this one draws no random numbers")
]

ConfirmOption = Annotated[
    bool,
    typer.Option(
        "--confirm/--no-confirm",
        help="run what was found through the Drake diagram too, a quarter as long as the recordings take",
    ),
]


def parse_settings(pairs: Iterable[str] | None) -> dict[str, str]:
    """Path -> value as text.

    Raises:
        InputError: a pair without `=`, or the same path twice.
    """
    settings: dict[str, str] = {}
    for pair in pairs or ():
        path, equals, value = pair.partition("=")
        path, value = path.strip(), value.strip()
        if not (equals and path and value):
            raise InputError(f"--set {pair}: write path=value, such as --set 'supply.pressure=12 MPa'")
        if path in settings:
            raise InputError(f"--set {path} is given twice, {settings[path]} and {value}")
        settings[path] = value
    return settings
