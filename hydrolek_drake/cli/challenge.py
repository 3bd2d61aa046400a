"""`hydrolek challenge`: concealed machines of the project's own, diagnosed and scored."""

import json
import os
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
    out: Annotated[Path, typer.Option(metavar="DIR", help="folder for cases and results")] = Path(
        "out/challenge"
    ),
) -> None:
    """Draw machines with concealed effects, diagnose them, then open the labels and score.

    Finished cases are kept: the same command goes on where it was interrupted.
    """
    from concurrent.futures import ThreadPoolExecutor

    from hydrolek_drake.challenge.build import BENCH, rig_names
    from hydrolek_drake.challenge.calibration import calibration_png
    from hydrolek_drake.challenge.cases import KINDS, digest, draw_cases, labels_of, read_case, record
    from hydrolek_drake.challenge.confusion import confusion_markdown
    from hydrolek_drake.challenge.scoring import markdown, score, summaries, summaries_markdown
    from hydrolek_drake.challenge.visibility import visibility_markdown
    from hydrolek_drake.cli.output import console, progress
    from hydrolek_drake.diagnosis.diagnosis import diagnose
    from hydrolek_drake.diagnosis.inquiry import INTERRUPTED
    from hydrolek_drake.diagnosis.report_json import as_json
    from hydrolek_drake.files import write_whole
    from hydrolek_drake.recordings import read_recording
    from hydrolek_drake.rigs import load_rig
    from hydrolek_drake.runs.report import prepare_folder

    for name, value in (("--cases", cases), ("--workers", workers), ("--first", first)):
        if value is not None and value < 1:
            raise InputError(f"{name} {value}: at least 1 is needed")
    if kind not in (known := [name for name, _ in KINDS]) and kind != "all":
        raise InputError(f"--kind {kind}: no such cases; choose {', '.join([*known, 'all'])}")
    output = console()
    drawn_of = rig_names(rig)
    prepare_folder(out)
    rigs = {name: load_rig(name, {}) for name in dict.fromkeys(drawn_of)}
    kinds = KINDS if kind == "all" else ((kind, 1.0),)
    sample = f"{cases}_{seed}" if rig == BENCH else f"{rig}_{cases}_{seed}"
    sample = sample if kind == "all" else f"{kind}_{sample}"
    kept = out / f"labels_{sample}.json"
    with progress("starting") as tell:
        if kept.exists():
            labels = kept.read_text()
        else:
            tell("drawing machines (sizes are found by simulation) ...")
            labels = labels_of(draw_cases([rigs[name] for name in drawn_of], cases, seed, kinds))
            write_whole(kept, labels)
    output.print(f"sha256 of the labels: {digest(labels)}")
    told: list[dict[str, Any]] = json.loads(labels)[:first]
    results = []
    with progress("starting") as tell, ThreadPoolExecutor(workers or os.cpu_count() or 1) as pool:
        for number, label in enumerate(told, start=1):
            tell(f"case {number} of {len(told)} ...")
            folder = out / f"{label['name']}_{sample}"
            report = folder / "report.json"
            if not report.exists():
                case = read_case(label)
                machine = rigs[case.rig]
                record(machine, case, folder)
                recordings = [
                    read_recording(folder / f"{side}.csv", machine.columns) for side in ("train", "holdout")
                ]
                done = diagnose(machine, recordings[:1], recordings[1:], pool)
                if INTERRUPTED in done.reasons:
                    raise KeyboardInterrupt
                write_whole(report, json.dumps(as_json(done), indent=1))
            answered = json.loads(report.read_text())
            tell(f"case {number} of {len(told)}: {answered['verdict']}")
            results.append(score(label, answered))
    told_by = summaries(results)
    write_whole(out / "summary.json", json.dumps({"summary": told_by, "cases": results}, indent=1))
    write_whole(out / "summary.md", summaries_markdown(told_by))
    write_whole(out / "cases.md", markdown(results))
    write_whole(out / "confusion.md", confusion_markdown(results))
    write_whole(out / "visibility.md", visibility_markdown(results))
    write_whole(out / "calibration.png", calibration_png(told_by["all"]["calibration"]))
    output.print(summaries_markdown(told_by), markup=False, soft_wrap=True)
    output.print(f"cases, confusion, visibility and calibration: {out}", markup=False, soft_wrap=True)
