"""`hydrolek identify two-step`: mechanics with a gain, then the hydraulics (thesis 4.3 and 4.7)."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.inputs import refuse_twice, rig_and_recordings
from hydrolek_drake.cli.settings import ConfirmOption, SetOption
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from hydrolek_drake.recordings import Recording
    from hydrolek_drake.rigs import Rig


def two_step(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="a rig of one hydraulic joint")],
    recordings: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="RECORDING",
            help="command and angle, fitted together; none: simulate a machine that differs",
        ),
    ] = None,
    holdout: Annotated[
        list[Path] | None, typer.Option(metavar="RECORDING", help="only compared with (repeatable)")
    ] = None,
    starts: Annotated[
        int | None, typer.Option(min=1, help="of the fits of step two and polish; the default is 2")
    ] = None,
    polish: Annotated[
        bool, typer.Option(help="fit all parameters together at the end, which the thesis does not")
    ] = True,
    confirm: ConfirmOption = True,
    set_: SetOption = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="folder for numbers, picture, rig and simulated recordings"),
    ] = None,
    seed: Annotated[int, typer.Option(help="of machine, noise and random starts")] = 1,
) -> None:
    """Mechanical parameters with a gain for the hydraulics, the hydraulic ones of Table 4.1, then all together.

    Ctrl-C gives the steps that were finished.
    """
    from rich.console import Console
    from rich.table import Table

    from hydrolek_drake.cli.output import console

    refuse_twice([*(recordings or []), *(holdout or [])])
    if holdout and not recordings:
        raise InputError("identify two-step: --holdout needs recordings to fit; give RECORDING before it")
    loaded, (fitted, held) = rig_and_recordings(rig, set_, recordings, holdout)

    from hydrolek_drake.identification.two_step.estimate import identify_two_step
    from hydrolek_drake.identification.two_step.report import relative_errors, sentences, write_report
    from hydrolek_drake.identification.two_step.settings import only_joint

    only_joint(loaded)
    output, progress = console(), Console(stderr=True)
    machine = None
    with progress.status("reading") as status:
        if not recordings:
            status.update("simulating a machine under set-point sequences")
            machine, fitted, held = _simulated(loaded, seed, out)
        found = identify_two_step(
            loaded, fitted, holdout=held, starts=starts, polish=polish, seed=seed, progress=status.update
        )
    table = Table("model", "fitted [deg rms]", "held out [deg rms]", "evaluations")
    for stage in found.stages:
        outside = "" if stage.held_deg is None else f"{stage.held_deg:.3g}"
        table.add_row(stage.name, f"{stage.fitted_deg:.3g}", outside, str(stage.evaluations or ""))
    output.print(table)
    output.print(f"noise of the angle: {found.noise_deg:.3g} deg", soft_wrap=True)
    if machine is not None:
        for stage in found.stages:
            if stage.values:
                off = relative_errors(stage, machine)
                output.print(
                    f"{stage.name}: {off.size} parameters that the machine has too are off by "
                    f"{100.0 * sorted(off)[off.size // 2]:.1f} % in the median, {100.0 * off.max():.0f} % at worst",
                    soft_wrap=True,
                )
    for sentence in sentences(found):
        output.print(sentence, markup=False, soft_wrap=True)
    if out is not None:
        for path in write_report(found, out, machine):
            output.print(f"wrote {path}", markup=False, soft_wrap=True)
    if found.interrupted:
        raise KeyboardInterrupt
    if confirm:
        from hydrolek_drake.replay.confirmation import confirm as run_confirmation

        with progress.status("Drake diagram") as status:
            confirmed = run_confirmation(found.rig, held or fitted, status.update)
        for each in confirmed:
            output.print(each.sentence(), markup=False, soft_wrap=True)


def _simulated(rig: "Rig", seed: int, out: Path | None) -> "tuple[Rig, list[Recording], list[Recording]]":
    """A machine that differs from the rig, and its recordings of estimation and validation."""
    import numpy as np

    from hydrolek_drake.identification.two_step.machine import PARTS, other_machine, record_sequence
    from hydrolek_drake.recordings.writing import write_recording

    rng = np.random.default_rng(seed)
    machine = other_machine(rig, rng)
    made = [record_sequence(machine, rig, part, rng) for part in PARTS]
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
        for recording in made:
            write_recording(recording, out / f"{recording.name}.csv")
    return machine, made[:1], made[1:]
