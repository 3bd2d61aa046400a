"""`hydrolek export`: a rig's model as a unit (FMU) for other programs."""

from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.settings import SeedOption, SetOption, parse_settings
from hydrolek_drake.errors import InputError


def export(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    out: Annotated[
        Path, typer.Option("--out", "-o", "--fmu", metavar="FILE", help="the unit, such as model.fmu")
    ],
    joint: Annotated[
        list[str] | None,
        typer.Option(help="a joint that is commanded, again for more; all of the rig by default"),
    ] = None,
    fmi: Annotated[int, typer.Option(help="version of FMI: 2 or 3")] = 2,
    step: Annotated[
        float, typer.Option(help="communication step that is suggested to simulators [s]")
    ] = 0.01,
    stop: Annotated[float, typer.Option(help="when simulators end unless told otherwise [s]")] = 10.0,
    set_: SetOption = None,
    seed: SeedOption = None,
) -> None:
    """Write a rig's model as an FMU for co-simulation: commands in, position and pressures out.

    It runs wherever a Python with this package does (docs/guides/fmu.md).
    """
    import math

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.rigs import load_rig

    if fmi not in (2, 3):
        raise InputError(f"--fmi {fmi}: choose 2 or 3")
    for name, value in (("--step", step), ("--stop", stop)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"{name} {value:g}: seconds above 0 are needed")
    loaded = load_rig(rig, parse_settings(set_))
    for each in joint or ():
        if each not in loaded.joints:
            raise InputError(f"--joint {each}: rig {loaded.name} has {', '.join(loaded.joints)}")

    from hydrolek_drake.fmu.exporting import export as write
    from hydrolek_drake.fmu.variables import INPUT, OUTPUT, variables_of

    joints = [each for each in loaded.joints if not joint or each in joint]
    write(loaded, joints, out, fmi, step, stop)
    output = console()
    output.print(f"wrote {out}: FMI {fmi}, co-simulation", markup=False, soft_wrap=True)
    for kind, told in ((INPUT, "in"), (OUTPUT, "out")):
        names = [f"{v.name} [{v.unit}]" for v in variables_of(loaded, joints) if v.causality == kind]
        output.print(f"{told}: {', '.join(names)}", markup=False, soft_wrap=True)
