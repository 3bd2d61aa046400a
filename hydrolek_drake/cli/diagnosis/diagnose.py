"""`hydrolek diagnose`: locate the mismatch, name the missing physics, model it, show the fit improve."""

import contextlib
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from hydrolek_drake.cli.inputs import refuse_twice, rig_and_recordings, tell_what_looks_wrong
from hydrolek_drake.cli.settings import ConfirmOption, SeedOption, SetOption
from hydrolek_drake.errors import InputError

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from hydrolek_drake.replay.confirmation import Confirmation


def diagnose(
    rig: Annotated[str, typer.Argument(metavar="RIG", help="name of a built-in rig, or a rig file")],
    recordings: Annotated[list[Path], typer.Argument(metavar="RECORDING", help="recordings to explain")],
    holdout: Annotated[
        list[Path] | None,
        typer.Option(metavar="RECORDING", help="recording that decides and is not fitted (repeatable)"),
    ] = None,
    between: Annotated[
        tuple[float, float] | None,
        typer.Option(
            metavar="START END",
            help="fit this part of the recordings only [s]; without --holdout the rest of them is held out",
        ),
    ] = None,
    workers: Annotated[
        int | None, typer.Option(help="threads; as many as there are cores by default")
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="roll out on an existing Dask cluster, such as tcp://host:8786"),
    ] = None,
    at_most: Annotated[
        float | None,
        typer.Option(metavar="MINUTES", help="end the search then, with what is known by that time"),
    ] = None,
    confirm: ConfirmOption = True,
    set_: SetOption = None,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="folder for report, fitted rig and residuals")
    ] = None,
    seed: SeedOption = None,
) -> None:
    """Find out what physics a rig's model leaves out, from recordings of the machine."""
    from hydrolek_drake.cli.output import console, progress

    if workers is not None and workers < 1:
        raise InputError(f"--workers {workers}: at least 1 is needed")
    if workers is not None and cluster is not None:
        raise InputError("--workers is for threads here, --cluster for other computers; give one of them")
    if at_most is not None and not 0.0 < at_most < math.inf:
        raise InputError(f"--at-most {at_most:g}: minutes must be more than 0")
    refuse_twice([*recordings, *(holdout or [])], "; held-out data must be other data")
    output = console()
    loaded, (train, held) = rig_and_recordings(rig, set_, recordings, holdout)

    from hydrolek_drake.diagnosis.diagnosis import diagnose as run_diagnosis
    from hydrolek_drake.diagnosis.remarks import INTERRUPTED
    from hydrolek_drake.diagnosis.report.files import write_report
    from hydrolek_drake.diagnosis.report.table import summary
    from hydrolek_drake.runs.report import prepare_folder
    from hydrolek_drake.runs.time_limit import ended_after

    if out is not None:
        prepare_folder(out)
    with progress("starting") as tell, _pool(workers, cluster) as (pool, count):
        tell("checking (the first time, the physics is compiled: half a minute) ...")
        tell_what_looks_wrong(loaded, [*train, *held], output)

        def say(text: str) -> None:
            tell(f"{text} ...")

        with ended_after(None if at_most is None else 60.0 * at_most) as limit:
            try:
                done = run_diagnosis(
                    loaded, train, held, pool, say=say, between=between, cores=count, more=tell.more
                )
            except KeyboardInterrupt:
                if not limit.reached:
                    raise
                raise InputError(
                    f"--at-most {at_most:g}: ended before anything could be told; give it longer"
                ) from None
        confirmed: list[Confirmation] = []
        if confirm and done.bench is not None and INTERRUPTED not in done.reasons:
            from hydrolek_drake.replay.confirmation import confirm as run_confirmation

            told = held or [each if between is None else each.between(*between) for each in train]
            confirmed = run_confirmation(done.fitted_rig(), told, say, tell.more)
        if out is not None:
            tell("writing the report ...")
            page = write_report(done, out, confirmed)
    for line in summary(done):
        output.print(line, soft_wrap=True)
    for each in confirmed:
        output.print(each.sentence(), markup=False, soft_wrap=True)
    if out is not None:
        output.print(f"\nreport: {page}", markup=False, soft_wrap=True)
    if INTERRUPTED in done.reasons and not limit.reached:
        raise KeyboardInterrupt


@contextlib.contextmanager
def _pool(workers: int | None, cluster: str | None) -> "Iterator[tuple[Executor, int]]":
    """Threads that roll out here or on a cluster, and how many."""
    from concurrent.futures import ThreadPoolExecutor

    if cluster is not None:
        from hydrolek_drake.identification.search.cluster_pool import ClusterPool

        with ClusterPool(cluster) as pool:
            yield pool, pool.cores
        return
    count = workers or os.cpu_count() or 1
    with ThreadPoolExecutor(count) as threads:
        yield threads, count
