"""`hydrolek fmu`: other programs' units (FMU) in place of a machine."""

import math
from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption
from hydrolek_drake.errors import InputError

fmu = typer.Typer(add_completion=False, rich_markup_mode=None, no_args_is_help=True)
"""The commands."""


@fmu.command()
def show(
    file: Annotated[Path, typer.Argument(metavar="FMU", help="the unit")],
    seed: SeedOption = None,
) -> None:
    """List the variables of a unit, and which of them are signals by their own name; nothing of it runs."""
    from rich.table import Table

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.fmu.foreign import read_unit
    from hydrolek_drake.fmu.wiring import wired

    unit = read_unit(file)
    inputs, outputs = wired(unit, {}, {})
    known = {wire.variable: wire.key for wire in (*inputs, *outputs)}
    output = console()
    by, platforms = unit.tool or "an unknown tool", ", ".join(unit.platforms) or "no platform"
    output.print(_plain(f"{unit.name}: FMI {unit.fmi}, by {by}, for {platforms}"), soft_wrap=True)
    table = Table("variable", "unit", "kind", "start", "signal", "meaning")
    for each in unit.variables.values():
        if each.number and each.causality in ("input", "output", "parameter"):
            table.add_row(
                *(_plain(t) for t in (each.name, each.unit, each.causality, each.start)),
                known.get(each.name, ""),
                _plain(each.description),
            )
    output.print(table)


@fmu.command()
def record(
    file: Annotated[Path, typer.Argument(metavar="FMU", help="the unit, for co-simulation by FMI 2 or 3")],
    command: Annotated[Path, typer.Option(metavar="FILE", help="recording whose commands drive it")],
    out: Annotated[Path, typer.Option("--out", "-o", metavar="FILE", help="recording, .csv or .parquet")],
    map_: Annotated[
        list[str] | None,
        typer.Option(
            "--map",
            metavar="VARIABLE=SIGNAL",
            help="which signal a variable is, with its unit: cyl1.x=boom.position_mm; 'ignore' for none",
        ),
    ] = None,
    rig: Annotated[
        str | None,
        typer.Option(help="a rig whose names for columns, noise and resolution are taken"),
    ] = None,
    sample_time: Annotated[
        float | None, typer.Option(help="of the recording and the unit's steps [s]; the command's by default")
    ] = None,
    noise: Annotated[
        list[str] | None,
        typer.Option(metavar="SIGNAL=SIZE", help="standard deviation: boom.angle_deg=0.05"),
    ] = None,
    resolution: Annotated[
        list[str] | None, typer.Option(metavar="SIGNAL=STEP", help="of a sensor: boom.angle_deg=0.02")
    ] = None,
    set_: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="VARIABLE=VALUE", help="a parameter of the unit, in its own unit"),
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="of the noise")] = 0,
    at_most: Annotated[float, typer.Option(help="how long it may take [s]")] = 300.0,
) -> None:
    """Drive a unit with recorded commands and write what it does as a recording.

    It runs in a process of its own; but a unit is a program: run those of people whose programs you would run.
    """
    import numpy as np
    from rich.console import Console

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.fmu.foreign import read_unit
    from hydrolek_drake.fmu.recording import Sensors, record_unit, sensors_of
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.recordings.writing import write_recording
    from hydrolek_drake.rigs import load_rig

    for name, value in (("--sample-time", sample_time), ("--at-most", at_most)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name} {value:g}: seconds above 0 are needed")
    if out.suffix.lower() not in (".csv", ".parquet"):
        raise InputError(f"--out {out}: use the extension .csv or .parquet")
    if not out.absolute().parent.is_dir():
        raise InputError(f"--out {out}: there is no folder {out.parent}")
    mapping = _pairs("--map", map_, "cyl1.x=boom.position_mm")
    start = {name: _number("--set", name, text) for name, text in _pairs("--set", set_, "mass=120").items()}
    sizes, steps = _sizes("--noise", noise), _sizes("--resolution", resolution)
    machine = load_rig(rig, {}) if rig is not None else None
    given = sensors_of(machine) if machine is not None else Sensors()
    sensors = Sensors({**given.noise, **sizes}, {**given.resolution, **steps})
    driving = read_recording(command, machine.columns if machine is not None else {})
    with Console(stderr=True).status(f"running {file}"):
        made = record_unit(
            read_unit(file),
            driving,
            np.random.default_rng(seed),
            mapping=mapping,
            rig=machine,
            sensors=sensors,
            sample_time=sample_time,
            start=start,
            at_most=at_most,
        )
    for option, asked in (("--noise", sizes), ("--resolution", steps)):
        for key in asked:
            if key not in made.signals:
                raise InputError(f"{option} {key}: the recording has {', '.join(made.signals)}")
    write_recording(made, out)
    console().print(
        f"wrote {out}: {made.time.size} samples in {made.duration:g} s of {', '.join(made.signals)}",
        markup=False,
        soft_wrap=True,
    )


def _plain(text: str) -> str:
    """Text of a stranger for a table cell: printable, and no markup."""
    from rich.markup import escape

    return escape("".join(c if c.isprintable() else " " for c in text)[:120])


def _pairs(option: str, given: list[str] | None, example: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for pair in given or ():
        name, equals, value = (part.strip() for part in pair.rpartition("="))
        if not (equals and name and value):
            raise InputError(f"{option} {pair}: write it as {option} {example}")
        if name in found:
            raise InputError(f"{option} {name} is given twice")
        found[name] = value
    return found


def _number(option: str, name: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{option} {name}={text}: a number is needed")
    return value


def _sizes(option: str, given: list[str] | None) -> dict[str, float]:
    """Signal -> size in SI."""
    from hydrolek_drake.recordings.columns import parse_column

    found: dict[str, float] = {}
    for name, text in _pairs(option, given, "boom.angle_deg=0.05").items():
        understood = parse_column(name)
        if understood is None:
            raise InputError(f"{option} {name}: write <joint>.<quantity>_<unit>, such as boom.angle_deg=0.05")
        value = _number(option, name, text)
        if value < 0.0:
            raise InputError(f"{option} {name}={text}: 0 or more is needed")
        found[understood.key] = value * understood.factor
    return found
