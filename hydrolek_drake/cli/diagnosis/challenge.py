"""`hydrolek challenge`: concealed machines of the project's own, diagnosed and scored."""

import json
import os
import shutil
from pathlib import Path
from typing import Annotated, Any

import typer

from hydrolek_drake.errors import InputError


def challenge(
    cases: Annotated[int, typer.Option(help="how many machines are drawn")] = 200,
    first: Annotated[int | None, typer.Option(help="diagnose only so many of them, a fair sample")] = None,
    seed: Annotated[int, typer.Option(help="of machines, effects, commands and noise")] = 1,
    rig: Annotated[
        str,
        typer.Option(
            help="whose machines: joint_bench, hydrolek_left_j1 to hydrolek_right_j5, arms (all ten joints), "
            "or all (the bench too)"
        ),
    ] = "joint_bench",
    kind: Annotated[
        str,
        typer.Option(help="what they conceal: healthy, single, double or unlisted; or all, in their shares"),
    ] = "all",
    workers: Annotated[
        int | None, typer.Option(help="threads; as many as there are cores by default")
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="diagnose on an existing Dask cluster, one case on each worker, such as tcp://host:8786",
        ),
    ] = None,
    earlier: Annotated[
        Path | None,
        typer.Option(
            help="summary.json of the same command elsewhere: what is scored there is not run again"
        ),
    ] = None,
    plants: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="no machines are drawn: FMUs of this list, and what each conceals, take their place "
            "(docs/guides/fmu.md)",
        ),
    ] = None,
    out: Annotated[Path, typer.Option(metavar="DIR", help="folder for cases and results")] = Path(
        "out/challenge"
    ),
) -> None:
    """Draw machines with concealed effects, diagnose them, then open the labels and score.

    Machines drawn and finished cases are kept and scored: the same command goes on where it was interrupted.
    """
    for name, value in (("--cases", cases), ("--workers", workers), ("--first", first)):
        if value is not None and value < 1:
            raise InputError(f"{name} {value}: at least 1 is needed")

    if cluster is not None and (workers is not None or plants is not None):
        raise InputError(
            "--cluster is for drawn machines on other computers: no --workers, no --plants beside it"
        )

    from concurrent.futures import ThreadPoolExecutor

    from hydrolek_drake.challenge.build import BENCH, rig_names
    from hydrolek_drake.challenge.cases import digest, labels_of
    from hydrolek_drake.challenge.diagnosed import Series
    from hydrolek_drake.challenge.drawing import KINDS, draw_cases
    from hydrolek_drake.challenge.results import earlier_scores, write_results
    from hydrolek_drake.challenge.scoring import summaries_markdown
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.files import read_kept, write_whole
    from hydrolek_drake.rigs import load_rig
    from hydrolek_drake.runs.report import prepare_folder

    if kind not in (known := [name for name, _ in KINDS]) and kind != "all":
        raise InputError(f"--kind {kind}: no such cases; choose {', '.join([*known, 'all'])}")
    output = console()
    foreign: dict[str, Any] = {}
    rigs: dict[str, Any] = {}
    if plants is not None:
        from hydrolek_drake.challenge.plants import read_plants

        foreign = read_plants(plants)
        prepare_folder(out)
        labels = json.dumps([plant.label for plant in foreign.values()], sort_keys=True, indent=1)
        sample = f"{plants.stem}_{digest(labels)[:12]}"
        write_whole(out / f"labels_{sample}.json", labels)
    else:
        drawn_of = rig_names(rig)
        prepare_folder(out)
        rigs = {name: load_rig(name, {}) for name in dict.fromkeys(drawn_of)}
        kinds = KINDS if kind == "all" else ((kind, 1.0),)
        sample = f"{cases}_{seed}" if rig == BENCH else f"{rig}_{cases}_{seed}"
        sample = sample if kind == "all" else f"{kind}_{sample}"
        kept = out / f"labels_{sample}.json"
        if kept.exists():
            read_kept(kept, "the list of machines drawn before")
            labels = kept.read_text()
        else:
            drawn_so_far = out / f"labels_{sample}"
            prepare_folder(drawn_so_far)
            with progress("starting") as tell, ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
                machines = [rigs[name] for name in drawn_of]
                labels = labels_of(draw_cases(machines, cases, seed, kinds, drawn_so_far, pool, tell))
            write_whole(kept, labels)
            shutil.rmtree(drawn_so_far)
    sha256 = digest(labels)
    output.print(f"sha256 of the labels: {sha256}")
    told: list[dict[str, Any]] = json.loads(labels)[:first]
    scored = earlier_scores(earlier, sha256) if earlier else {}
    try:
        with progress("starting") as tell:
            cases_left = Series(told, scored, out, sample, rigs, foreign, tell, tell.more)
            if cluster is None:
                cases_left.here(workers or os.cpu_count() or 1)
            else:
                cases_left.over(cluster)
    finally:  # interrupted too: what is known by then
        known_by_now = [scored[label["name"]] for label in told if label["name"] in scored]
        told_by = write_results(out, sha256, known_by_now)
    output.print(summaries_markdown(told_by), markup=False, soft_wrap=True)
    output.print(f"cases, confusion, visibility and calibration: {out}", markup=False, soft_wrap=True)
