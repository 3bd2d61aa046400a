"""`hydrolek identify`: models straight from recordings."""

from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.identification.force import force
from hydrolek_drake.cli.identification.two_step import two_step
from hydrolek_drake.cli.settings import SetOption, parse_settings
from hydrolek_drake.errors import InputError

identify = typer.Typer(add_completion=False, rich_markup_mode=None)


@identify.callback()
def _identify() -> None:
    """Identify models from recordings, or from experiments on the simulated machine."""


@identify.command()
def sdp(
    recordings: Annotated[
        list[Path] | None,
        typer.Argument(metavar="RECORDING", help="files with step tests; none: simulate them on --rig"),
    ] = None,
    rig: Annotated[
        str | None,
        typer.Option(metavar="RIG", help="machine that is simulated, or that gives ranges and column names"),
    ] = None,
    joint: Annotated[
        list[str] | None, typer.Option(metavar="JOINT", help="only this joint (repeatable); else all")
    ] = None,
    moving: Annotated[
        bool, typer.Option("--moving", help="simulate and save also steps while the joint moves (6.1.1)")
    ] = False,
    fine: Annotated[
        bool, typer.Option("--fine", help="simulate also steps of tenths of a volt near the dead-zone")
    ] = False,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for numbers, model, pictures, step tests")
    ] = None,
    seed: Annotated[int, typer.Option(help="of noise and validation voltages")] = 1,
) -> None:
    """State-dependent-parameter models (thesis chapter 6) from open-loop step tests."""
    import numpy as np
    from rich.table import Table

    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.identification.sdp.campaign import (
        recorded_joints,
        simulated_joint,
        write_campaign,
    )
    from hydrolek_drake.identification.sdp.identify import SdpIdentification
    from hydrolek_drake.identification.sdp.report import mean_errors, thesis_error, write_report
    from hydrolek_drake.identification.sdp.validation import ValidationRun, validate
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.rigs import load_rig

    if not recordings and rig is None:
        raise InputError("identify sdp: give recordings of step tests, or --rig RIG to simulate them")
    loaded = None if rig is None else load_rig(rig, parse_settings(set_))
    output = console()
    rng = np.random.default_rng(seed)
    results: list[tuple[SdpIdentification, list[ValidationRun]]] = []
    with progress("reading" if recordings else "simulating step tests") as tell:
        if recordings:
            columns = {} if loaded is None else loaded.columns
            read = [read_recording(path, columns) for path in recordings]
            for found in recorded_joints(read, joint, loaded):
                results.append((found, []))
        else:
            assert loaded is not None
            for name in joint or loaded.joints:
                tell(f"step tests of {name}")
                machine, tests, found = simulated_joint(loaded, name, rng, moving, fine)
                if out is not None:
                    write_campaign(tests, name, out)
                tell(f"validation of {name}: six runs of five minutes")
                results.append((found, validate(found.model, machine.angle, rng)))
    table = Table("joint", *(f"alpha{i}" for i in range(1, 7)), "delay [s]", "s_n", "s_p", "a1")
    for found, _ in results:
        cells = [
            f"{value:.4f} ±{error:.2g}"
            for value, error in zip(found.exponential.values, found.exponential.errors, strict=True)
        ]
        free = np.nanmedian([step.a1 for step in found.steps])
        inverse = found.inverse
        table.add_row(
            found.joint,
            *cells,
            f"{found.model.delay_samples * found.model.sample_s:.2f}",
            f"{inverse.slope_negative:.3f}",
            f"{inverse.slope_positive:.3f}",
            f"{free:.3f}",
        )
    output.print(table)
    for found, runs in results:
        for kind, value in mean_errors(runs).items():
            printed = thesis_error(kind, found.joint)
            beside = "" if printed is None else f"; thesis, on the machine: {printed:g} deg²"
            output.print(
                f"{found.joint}, {kind}: mean squared error {value:.3g} deg²{beside}", soft_wrap=True
            )
        times = [step.dead_time_s for step in found.steps if step.moving]
        output.print(
            f"{found.joint}: dead time of single steps {min(times):.3f} to {max(times):.3f} s", soft_wrap=True
        )
    if out is not None:
        for path in write_report(results, out):
            output.print(f"wrote {path}", markup=False, soft_wrap=True)


identify.command("two-step")(two_step)
identify.command()(force)
