"""`hydrolek sensitivity`: which parameters matter, and when."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.inputs import rig_and_recordings
from hydrolek_drake.cli.settings import SetOption

if TYPE_CHECKING:  # what writes to a terminal is loaded when it is needed
    from rich.status import Status


def _update(status: "Status", name: str, form: str, *values: object) -> None:
    status.update(f"{name}: {form.format(*values)}")


def sensitivity(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    recording: Annotated[
        Path | None,
        typer.Argument(metavar="RECORDING", help="whose command drives the joint; else random levels"),
    ] = None,
    joint: Annotated[
        list[str] | None, typer.Option(metavar="JOINT", help="only this joint (repeatable); else all")
    ] = None,
    parameter: Annotated[
        list[str] | None,
        typer.Option(metavar="PATH", help="only this parameter (repeatable); else the whole chain"),
    ] = None,
    spread: Annotated[
        float, typer.Option(help="part of its value by which a parameter without a range is varied")
    ] = 0.2,
    segments: Annotated[int, typer.Option(min=1, help="equal parts of the time")] = 8,
    trajectories: Annotated[int, typer.Option(min=2, help="of the elementary effects (Morris)")] = 10,
    sobol: Annotated[
        int | None,
        typer.Option(metavar="N", help="also Sobol indices, from N (parameters + 2) runs; a power of two"),
    ] = None,
    surface: Annotated[
        tuple[str, str] | None,
        typer.Option(
            metavar="PATH PATH", help="draw the largest error over these two parameters instead (figure 4.11)"
        ),
    ] = None,
    top: Annotated[int, typer.Option(min=1, help="rows of the table")] = 20,
    set_: SetOption = None,
    out: Annotated[Path | None, typer.Option(metavar="DIR", help="folder for numbers and pictures")] = None,
    seed: Annotated[int, typer.Option(help="of command and trajectories")] = 1,
) -> None:
    """Rank a joint's parameters by what they change in its reading, one at a time and all together."""
    import numpy as np
    from rich.console import Console
    from rich.table import Table

    from hydrolek_drake.cli.output import console
    from hydrolek_drake.identification.sensitivity.points import check_points

    if sobol is not None:
        check_points(sobol)
    output, progress = console(), Console(stderr=True)
    loaded, (reads,) = rig_and_recordings(rig, set_, [] if recording is None else [recording])
    read = reads[0] if reads else None

    present = [name for name in loaded.joints if read is None or f"{name}.command" in read.signals]
    names = joint or present or list(loaded.joints)
    if surface is not None:
        from hydrolek_drake.identification.sensitivity.surface import performance_surface, write_surface

        for name in names:
            with progress.status(name) as status:
                found = performance_surface(
                    loaded,
                    name,
                    surface,
                    np.random.default_rng(seed),
                    recording=read,
                    spread=spread,
                    progress=partial(_update, status, name, "{} of {}"),
                )
            output.print(found.sentence(), soft_wrap=True)
            if out is not None:
                for written in write_surface(found, out):
                    output.print(f"wrote {written}", markup=False, soft_wrap=True)
        return

    from hydrolek_drake.identification.sensitivity.report import short, write_study
    from hydrolek_drake.identification.sensitivity.study import study_sensitivity

    for name in names:
        with progress.status(name) as status:
            study = study_sensitivity(
                loaded,
                name,
                np.random.default_rng(seed),
                recording=read,
                paths=parameter,
                spread=spread,
                segments=segments,
                trajectories=trajectories,
                sobol_points=sobol,
                say=partial(_update, status, name, "{}"),
            )
        unit = study.response.unit
        table = Table(
            f"{name}",
            f"mu* [{unit}]",
            f"sigma [{unit}]",
            f"one at a time [{unit}]",
            "most in segment",
            *(() if study.sobol is None else ("Sobol alone", "Sobol total")),
        )
        for i in study.ranking[:top]:
            table.add_row(
                short(study.paths[i], name),
                f"{np.sqrt((study.effects.mean_size[i] ** 2).mean()):.3g}",
                f"{np.sqrt((study.effects.deviation[i] ** 2).mean()):.3g}",
                f"{np.sqrt((study.one_at_a_time.spread[i] ** 2).mean()):.3g}",
                f"{int(np.argmax(study.effects.mean_size[i])) + 1}",
                *(
                    ()
                    if study.sobol is None
                    else (
                        f"{study.sobol.first_whole[i]:.3f}",
                        f"{study.sobol.total_whole[i]:.3f} ({study.sobol.total_low[i]:.3f} to "
                        f"{study.sobol.total_high[i]:.3f})",
                    )
                ),
            )
        output.print(table)
        if study.sobol is not None:
            alone = float(study.sobol.first_whole.sum())
            runs = study.sobol.points * (len(study.paths) + 2)
            output.print(
                f"{name}: parameters alone explain {100.0 * alone:.0f} % of the variance, the rest comes of several "
                f"together; {study.sobol.diverged} of {runs} runs diverged somewhere",
                soft_wrap=True,
            )
        output.print(
            f"{name}: {len(study.paths)} parameters varied, {len(study.varied.left_out)} left out; "
            f"{len(study.known.blurred())} combinations are not determined within their range by this command",
            soft_wrap=True,
        )
        for one, other, correlation in study.known.confused[:5]:
            output.print(
                f"{short(one, name)} and {short(other, name)} cannot be told apart "
                f"(correlation {correlation:+.3f})",
                soft_wrap=True,
            )
        if out is not None:
            for written in write_study(study, out):
                output.print(f"wrote {written}", markup=False, soft_wrap=True)
