"""`hydrolek fit`: a rig's free parameters from recordings."""

import math
from pathlib import Path
from typing import Annotated

import typer

from hydrolek_drake.cli.inputs import chosen, refuse_twice, rig_and_recordings, tell_what_looks_wrong
from hydrolek_drake.cli.settings import ConfirmOption, SetOption
from hydrolek_drake.errors import InputError


def fit(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    recordings: Annotated[list[Path], typer.Argument(metavar="RECORDING", help="fitted together")],
    method: Annotated[
        str, typer.Option(help="least-squares (recommended), cma, de, ga or nsga2 (the thesis's)")
    ] = "least-squares",
    parameter: Annotated[
        list[str] | None,
        typer.Option(metavar="PATH", help="only this parameter (repeatable); else all with a range"),
    ] = None,
    holdout: Annotated[
        list[Path] | None, typer.Option(metavar="RECORDING", help="only compared with (repeatable)")
    ] = None,
    budget: Annotated[int, typer.Option(min=1, help="simulations that a search may make")] = 8000,
    norm: Annotated[str, typer.Option(help="p of (4.13): 1, 2 or inf")] = "2",
    segments: Annotated[int, typer.Option(min=1, help="parts of the recordings for nsga2, (4.17)")] = 8,
    loss: Annotated[str, typer.Option(help="of least squares: linear, soft_l1, huber or cauchy")] = "linear",
    workers: Annotated[
        int, typer.Option(min=1, help="threads; processes with --overdue, --plant diagram")
    ] = 1,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler, such as tcp://host:8786")
    ] = None,
    overdue: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="an evaluation that takes longer has failed")
    ] = None,
    at_most: Annotated[
        float | None, typer.Option(metavar="MINUTES", help="end the search then, with the best so far")
    ] = None,
    profile: Annotated[
        list[str] | None,
        typer.Option(metavar="PATH", help="also the profile likelihood of this parameter (repeatable)"),
    ] = None,
    plant: Annotated[
        str,
        typer.Option(help="rollout: compiled; diagram: the Drake diagram itself, hundreds of times slower"),
    ] = "rollout",
    confirm: ConfirmOption = True,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for rig_fitted.yaml, fit.json, checkpoint")
    ] = None,
    seed: Annotated[int, typer.Option(help="of everything random")] = 1,
) -> None:
    """Estimate a rig's free parameters so that its model follows the recordings.

    Ctrl-C gives the best so far. With --out, the same command then goes on to the same result (all but
    least-squares, which starts anew).
    """
    from rich.table import Table

    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.identification.choices import LOSSES, METHODS, PLANTS

    chosen("method", method, METHODS)
    chosen("norm", norm, ("1", "2", "inf"))
    chosen("loss", loss, LOSSES)
    chosen("plant", plant, PLANTS)
    if at_most is not None and not 0.0 < at_most < math.inf:
        raise InputError(f"--at-most {at_most:g}: minutes must be more than 0")
    refuse_twice([*recordings, *(holdout or [])])
    loaded, (read, held) = rig_and_recordings(rig, set_, recordings, holdout)

    from hydrolek_drake.identification.fit import fit_rig, searched
    from hydrolek_drake.identification.fit.profiles import check_profiled, profiles_of, write_profiles
    from hydrolek_drake.identification.fit.report import sentences, write_fit
    from hydrolek_drake.identification.fit.standing import Standing
    from hydrolek_drake.identification.parameter_set import parameters_off
    from hydrolek_drake.runs.time_limit import ended_after

    output = console()
    with progress("checking (the first time, the physics is compiled: half a minute)"):
        tell_what_looks_wrong(loaded, [*read, *held], output)
    profiled = check_profiled(loaded, profile or [], [f.path for f in searched(loaded, read, parameter)])
    with progress(f"fitting by {method} ...") as tell:
        standing = Standing(None if method == "least-squares" else budget, tell.more)
        with ended_after(None if at_most is None else 60.0 * at_most) as limit:
            try:
                fitted = fit_rig(
                    loaded,
                    read,
                    method,
                    paths=parameter,
                    holdout=held,
                    budget=budget,
                    p=float(norm),
                    segments=segments,
                    loss=loss,
                    plant=plant,
                    seed=seed,
                    workers=workers,
                    cluster=cluster,
                    overdue=overdue,
                    checkpoint=None if out is None else out / f"checkpoint_{method}",
                    progress=standing.told,
                )
            except KeyboardInterrupt:
                if not limit.reached:
                    raise
                raise InputError(
                    f"--at-most {at_most:g}: ended before anything was fitted; give it longer"
                ) from None
    table = Table("parameter", "value", "95 % interval", "unit")
    for name, (value, low, high) in fitted.intervals().items():
        table.add_row(name, f"{value:.6g}", f"{low:.6g} to {high:.6g}", loaded.entries[name].unit)
    output.print(table)
    off = [] if parameter else parameters_off(loaded)
    if off:
        told = f"off, so not fitted: {', '.join(off)} (--parameter fits one all the same)"
        output.print(told, markup=False, soft_wrap=True)
    for sentence in sentences(fitted):
        output.print(sentence, markup=False, soft_wrap=True)
    if out is not None:
        for file in write_fit(fitted, out):
            output.print(f"wrote {file}", markup=False, soft_wrap=True)
    if limit.reached:
        output.print(f"ended after {at_most:g} min, with the best so far", markup=False)
    elif fitted.interrupted:
        raise KeyboardInterrupt
    if confirm and not limit.reached:
        from hydrolek_drake.replay.confirmation import confirm as run_confirmation

        with progress("Drake diagram") as tell:
            confirmed = run_confirmation(fitted.rig, held or read, tell, tell.more)
        for each in confirmed:
            output.print(each.sentence(), markup=False, soft_wrap=True)
        if out is not None:
            write_fit(fitted, out, confirmed)
    if profiled and not limit.reached:
        with progress("profile likelihood ...") as tell:
            profiles = profiles_of(fitted, read, profiled, tell.more)
        for one in profiles:
            output.print(one.sentence(), markup=False, soft_wrap=True)
        if out is not None:
            for file in write_profiles(profiles, out):
                output.print(f"wrote {file}", markup=False, soft_wrap=True)
        if profiles[-1].curve.interrupted:
            raise KeyboardInterrupt
