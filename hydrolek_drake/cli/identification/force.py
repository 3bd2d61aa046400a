"""`hydrolek identify force`: a motor-driven joint's parameters from its force."""

from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.inputs import refuse_twice, rig_and_recordings
from hydrolek_drake.cli.settings import SeedOption, SetOption


def force(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="a rig of one motor-driven joint, such as emps")],
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING", help="command and position, regressed together")
    ],
    cutoff: Annotated[float, typer.Option(metavar="HZ", help="of the low-pass on the position")] = 60.0,
    decimation: Annotated[int, typer.Option(help="samples to one equation")] = 20,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for rig_fitted.yaml, force.json and picture")
    ] = None,
    seed: SeedOption = None,
) -> None:
    """Mass, friction and constant force (or gravity) by regressing the motor's force on the measured motion."""
    from rich.table import Table

    from hydrolek_drake.cli.output import console

    refuse_twice(recordings)
    loaded, (read,) = rig_and_recordings(rig, set_, recordings)

    from hydrolek_drake.identification.inverse_dynamics.regression import inverse_dynamics, motor_joint
    from hydrolek_drake.identification.inverse_dynamics.report import write_regression

    motor_joint(loaded)
    found = inverse_dynamics(loaded, read, cutoff_Hz=cutoff, decimation=decimation)
    output = console()
    table = Table("parameter", "value", "95 % interval", "in the rig", "unit")
    for name, (value, low, high) in found.intervals().items():
        table.add_row(
            name,
            f"{value:.6g}",
            f"{low:.6g} to {high:.6g}",
            f"{loaded.value(name):.6g}",
            loaded.entries[name].unit,
        )
    output.print(table)
    output.print(
        f"inverse dynamics of {len(read)} recording(s): {sum(t.size for t in found.time)} equations; they leave "
        f"{100.0 * found.misfit:.1f} % of the force (rms), neighbouring residuals correlated by "
        f"{found.correlation:.2f}",
        soft_wrap=True,
    )
    if out is not None:
        for file in write_regression(loaded, found, out):
            output.print(f"wrote {file}", markup=False, soft_wrap=True)
