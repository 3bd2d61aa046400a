"""Foreign machines, rigs from data sheets that are wrong: drawn, concealed, diagnosed and scored.

Draws ten machines, tells the digest of their labels, writes each rig with the wizard from its data sheet alone, and
diagnoses all of them, each once. A run that was cut off goes on.
"""

import argparse
import json
import math
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from hydrolek_drake.challenge.diagnosed import REPORT, diagnosed
from hydrolek_drake.challenge.foreign.drawing import Foreign, digest, draw_foreign, labels_of, record
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.runs.time_limit import ended_after
from hydrolek_drake.wizard.making import written_rig

LABELS = "labels.json"
SECONDS = "seconds.json"
RIGHT_FRICTIONS = {
    "cylinder.coulomb_friction": {"load.coulomb_friction"},
    "cylinder.stribeck_friction": {"load.stribeck_friction"},
}
"""Where the lever hardly changes, a friction at the rod is one at the joint."""


def drawn(out: Path, count: int, seed: int) -> list[Foreign]:
    """The cases, from an earlier run or drawn now."""
    path = out / LABELS
    if path.exists():
        return [Foreign(**label) for label in json.loads(path.read_text())]
    cases = draw_foreign(count, seed)
    write_whole(path, labels_of(cases))
    return cases


def run(case: Foreign, folder: Path, cores: int) -> None:
    """Record and diagnose one."""
    record(case, folder)
    text, _ = written_rig(f"foreign_{case.name}", case.sheet)
    rig_file = folder / "rig.yaml"
    write_whole(rig_file, text)
    rig = load_rig(str(rig_file), {})
    with ThreadPoolExecutor(cores) as pool:
        diagnosed(rig, folder, pool, cores)


def explained(report: dict) -> bool:
    """Whether the nominal model, fitted within the data sheet's ranges, leaves no more than an effect must to be seen.

    What an effect does is told before anything is fitted (`Foreign.shows`); a controller hides some of it, and a wrong
    number of the sheet may do the same.
    """
    baseline = report["fit"]["baseline"]
    return max(baseline["train_over_noise"], baseline["holdout_over_noise"]) <= NOISE.held_out


def row(case: Foreign, folder: Path) -> tuple[str, bool, bool]:
    """A line of the table, whether the answer is right, and whether the nominal model explains the case."""
    wanted = ", ".join(case.conceals) or "nothing"
    wrong = max(case.wrong, key=lambda key: abs(math.log(case.wrong[key])))
    machine = f"{case.kind}, {case.drive}{'' if case.pressures else ', no pressures'}"
    begin = f"| {case.name} | {machine} | {wrong} | {wanted} | {case.shows:.0f} |"
    if not (folder / REPORT).exists():
        return f"{begin} | not ended | | |", False, False
    report = json.loads((folder / REPORT).read_text())
    named = {each["id"] for each in report["effects"]}
    seconds = json.loads((folder / SECONDS).read_text())
    right = report["verdict"] == ("none" if not case.conceals else "missing_physics") and len(named) == len(
        case.conceals
    )
    for effect in case.conceals:
        right = right and bool(named & ({effect} | RIGHT_FRICTIONS.get(effect, set())))
    told = ", ".join(sorted(named)) or report["verdict"]
    left = report["fit"]["baseline"]["train_over_noise"]
    line = f"{begin} {left:.3g} | {told} | {'yes' if right else '**no**'} | {seconds:.0f} |"
    return line, right, explained(report)


def main() -> None:
    """Draw, diagnose, tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, default=10, help="machines, of four cases each")
    parser.add_argument("--cores", type=int, default=1)
    parser.add_argument("--part", default="1/1", help="1/2: every other case from the first")
    parser.add_argument(
        "--at-most",
        type=float,
        default=240.0,
        help="seconds of processor time of each core, recording included; a case that has not ended by then counts "
        "as wrong",
    )
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    cases = drawn(given.out, given.count, given.seed)
    print(f"labels {digest(labels_of(cases))}", flush=True)
    first, parts = (int(each) for each in given.part.split("/"))
    for case in cases[first - 1 :: parts]:
        folder = given.out / case.name
        if (folder / SECONDS).exists():
            continue
        with ended_after(given.at_most * given.cores, worked=True) as limit:
            started = time.process_time()
            try:
                run(case, folder, given.cores)
                told = "ended"
            except InputError as error:
                told = str(error)
            except KeyboardInterrupt:
                if not limit.reached:
                    raise
                told = "not ended"
            seconds = time.process_time() - started
        write_whole(folder / SECONDS, json.dumps(seconds))  # a case counts as it was first run
        print(f"{case.name}: {told}, {seconds:.0f} s", flush=True)
    print(
        "| case | machine | most wrong | concealed | shows, noise | nominal leaves, noise | told | right | s |"
    )
    print(9 * "|---" + "|")
    rows = [row(case, given.out / case.name) for case in cases]
    print("\n".join(line for line, _, _ in rows))
    scored = list(zip(cases, rows, strict=True))
    for title, of in (
        ("healthy", [right for case, (_, right, _) in scored if not case.conceals]),
        ("concealed", [right for case, (_, right, _) in scored if case.conceals]),
        (
            "concealed, and more than the nominal model explains",
            [right for case, (_, right, hidden) in scored if case.conceals and not hidden],
        ),
    ):
        print(f"{title}: {sum(of)} of {len(of)}")


if __name__ == "__main__":
    main()
