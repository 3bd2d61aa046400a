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

    from concurrent.futures import ThreadPoolExecutor

    from hydrolek_drake.challenge.build import BENCH, rig_names
    from hydrolek_drake.challenge.cases import digest, labels_of, read_case, record
    from hydrolek_drake.challenge.drawing import KINDS, draw_cases
    from hydrolek_drake.challenge.results import earlier_scores, write_results
    from hydrolek_drake.challenge.scoring import score, summaries_markdown
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.diagnosis.diagnosis import diagnose
    from hydrolek_drake.diagnosis.inquiry import INTERRUPTED
    from hydrolek_drake.diagnosis.report.as_json import as_json
    from hydrolek_drake.files import read_kept, write_whole
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.rigs import load_rig
    from hydrolek_drake.runs.report import prepare_folder

    if kind not in (known := [name for name, _ in KINDS]) and kind != "all":
        raise InputError(f"--kind {kind}: no such cases; choose {', '.join([*known, 'all'])}")
    output = console()
    foreign: dict[str, Any] = {}
    rigs: dict[str, Any] = {}
    if plants is not None:
        from hydrolek_drake.challenge.plants import read_plants, record_plant

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
        count = workers or os.cpu_count() or 1
        with progress("starting") as tell, ThreadPoolExecutor(count) as pool:
            for number, label in enumerate(told, start=1):
                if label["name"] in scored:
                    continue
                tell(f"case {number} of {len(told)} ...")
                folder = out / f"{label['name']}_{sample}"
                report = folder / "report.json"
                if not report.exists():
                    if foreign:
                        plant = foreign[label["name"]]
                        machine = plant.rig
                        record_plant(plant, folder)
                    else:
                        case = read_case(label)
                        machine = rigs[case.rig]
                        record(machine, case, folder)
                    recordings = [
                        read_recording(folder / f"{side}.csv", machine.columns)
                        for side in ("train", "holdout")
                    ]
                    done = diagnose(machine, recordings[:1], recordings[1:], pool, cores=count)
                    if INTERRUPTED in done.reasons:
                        raise KeyboardInterrupt
                    write_whole(report, json.dumps(as_json(done), indent=1))
                answered = read_kept(report, "the report of a case diagnosed before", ("verdict",))
                tell(f"case {number} of {len(told)}: {answered['verdict']}")
                scored[label["name"]] = score(label, answered)
    finally:  # interrupted too: what is known by then
        known_by_now = [scored[label["name"]] for label in told if label["name"] in scored]
        told_by = write_results(out, sha256, known_by_now)
    output.print(summaries_markdown(told_by), markup=False, soft_wrap=True)
    output.print(f"cases, confusion, visibility and calibration: {out}", markup=False, soft_wrap=True)
