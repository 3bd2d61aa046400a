"""What each idea of the diagnosis brings: concealed machines diagnosed by the whole method and without parts of it.

Machines are drawn once, the digest of their labels told; each is diagnosed once in each way, within a limit of
processor time. A run that was cut off goes on; parts of it may run side by side. With `--table` it only tells what
is known by then.
"""

import argparse
import json
import os
import statistics
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest import mock

from hydrolek_drake.challenge.build import rig_names
from hydrolek_drake.challenge.cases import digest, labels_of, read_case, record
from hydrolek_drake.challenge.diagnosed import REPORT, diagnosed
from hydrolek_drake.challenge.drawing import draw_cases
from hydrolek_drake.challenge.scoring import score, summary
from hydrolek_drake.diagnosis.fitting import race
from hydrolek_drake.diagnosis.fitting.entrants import Runner
from hydrolek_drake.diagnosis.search import by_continuation, elimination, enlarging, nominal
from hydrolek_drake.diagnosis.settings import Rung, Settings
from hydrolek_drake.diagnosis.structures import cost, workbench
from hydrolek_drake.errors import InputError
from hydrolek_drake.files import write_whole
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.runs.time_limit import ended_after

LABELS = "labels.json"
SECONDS = "seconds.json"
DRAWN = "drawn.json"
ROWS = (
    ("healthy", "false_alarms"),
    ("visible singles", "visible_singles_right"),
    ("barely visible", "barely_visible_singles_right"),
    ("doubles", "doubles_right"),
    ("in no list", "unlisted_recognised"),
)

Replaced = tuple[Any, str, Any]
"""Module, name, what stands there instead."""


def _with_settings(settings: Settings) -> list[Replaced]:
    return [(workbench, "Settings", lambda: settings)]


def _all_kept(rungs: Sequence[Rung]) -> tuple[Rung, ...]:
    """Nobody is out, however far behind, and each takes as many steps as the last rung lets."""
    most = max(rung.rounds for rung in rungs)
    return tuple(replace(rung, keep=10**6, each=10**6, rounds=most, behind=0.0) for rung in rungs)


def _everybody(runners: Sequence[Runner], *, few: bool) -> list[Runner]:
    return list(runners)


def _squares(fit: Fit) -> float:
    return fit.objective


USUAL = Settings()

WITHOUT: dict[str, list[Replaced]] = {
    "nothing": [],
    "continuation": [
        (enlarging, "continued", lambda bench, opening, left: ([], [])),
        (nominal, "continued_nominal", lambda bench, direct, reach: None),
        (by_continuation, "continued_to_the_end", lambda bench, fits, best: []),
        (elimination, "steps_for", lambda rungs, fine: ()),
    ],
    "starts": _with_settings(replace(USUAL, starts=1, scanned=1, doubled=0, to_the_end=1, drawn=0)),
    "racing": [
        *_with_settings(
            replace(
                USUAL,
                free=_all_kept(USUAL.free),
                continued=_all_kept(USUAL.continued),
                ended=_all_kept(USUAL.ended),
            )
        ),
        (race, "_in_reach", _everybody),
    ],
    "discrepancy": [(cost, "misfit", _squares)],
    "local search": [(by_continuation, "has_other_minima", lambda best, ended: False)],
    "exchange": [(enlarging, "without_each", lambda bench, found, candidates: None)],
}
"""Part of the method that is left out -> what stands in its place.

Without continuation observers still tell what additions promise; without racing the nominal model and the best
structures are still continued as they are.
"""


@contextmanager
def left_out(part: str) -> Iterator[None]:
    """The diagnosis without a part of its method."""
    with ExitStack() as stack:
        for where, name, instead in WITHOUT[part]:
            stack.enter_context(mock.patch.object(where, name, instead))
        yield


def drawn(out: Path, machines: Sequence[str], count: int, seed: int) -> list[dict[str, Any]]:
    """Labels of the cases, from an earlier run or drawn now."""
    path, asked = out / LABELS, {"machines": list(machines), "count": count, "seed": seed}
    if path.exists():
        before = json.loads((out / DRAWN).read_text())
        if before != asked:
            raise SystemExit(f"{out} holds the cases of {before}, not of {asked}: give another --out")
    else:
        rigs = [load_rig(name, {}) for name in machines]
        with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
            cases = draw_cases(rigs, count, seed, pool=pool)
        write_whole(out / DRAWN, json.dumps(asked))
        write_whole(path, labels_of(cases))
    labels = path.read_text()
    print(f"labels {digest(labels)}", flush=True)
    told: list[dict[str, Any]] = json.loads(labels)
    return told


def run(label: Mapping[str, Any], folder: Path, part: str, at_most: float) -> str:
    """Record and diagnose one case; how it ended, in a word."""
    case = read_case(label)
    rig = load_rig(case.rig, {})
    folder.mkdir(parents=True, exist_ok=True)
    began = time.process_time()
    with ended_after(at_most, worked=True) as limit, left_out(part):
        try:
            record(rig, case, folder)
            with ThreadPoolExecutor(1) as pool:
                diagnosed(rig, folder, pool, 1)
            told = "ended"
        except InputError as error:
            told = str(error)
        except KeyboardInterrupt:
            if not limit.reached:
                raise
            told = "not ended"
    write_whole(folder / SECONDS, json.dumps(time.process_time() - began))
    return told


def table(out: Path, told: Sequence[Mapping[str, Any]], parts: Sequence[str]) -> str:
    """One row a part that was left out, of the cases that were run in each way; what did not end is wrong."""
    ran = [part for part in parts if (out / part).exists()]
    ended = [label for label in told if all((out / part / label["name"] / SECONDS).exists() for part in ran)]
    names = " | ".join(name for name, _ in ROWS)
    lines = [f"| without | cases | {names} | all right | not ended | median s | mean s |"]
    lines.append("|---" * (len(ROWS) + 6) + "|")
    for part in ran if ended else ():
        folders = [out / part / label["name"] for label in ended]
        seconds = [json.loads((folder / SECONDS).read_text()) for folder in folders]
        scores = [_score(label, folder, out) for label, folder in zip(ended, folders, strict=True)]
        shares = summary(scores)
        cells = [_cell(shares[key], wrong=key == "false_alarms") for _, key in ROWS]
        right = sum(each["right"] for each in scores)
        cut = sum(not (folder / REPORT).exists() for folder in folders)
        lines.append(
            f"| {part} | {len(ended)} | {' | '.join(cells)} | {right} | {cut} | {statistics.median(seconds):.0f} | "
            f"{statistics.mean(seconds):.0f} |"
        )
    return "\n".join(lines)


def _score(label: Mapping[str, Any], folder: Path, out: Path) -> dict[str, Any]:
    """Of a report; what did not end says nothing, and is wrong whatever it was."""
    if (folder / REPORT).exists():
        return score(label, json.loads((folder / REPORT).read_text()))
    silent: dict[str, Any] = {
        "effects": [],
        "locations": [],
        "fit": None,
        "verdict": "not ended",
        "not_distinguishable": [],
        "seconds": 0.0,
    }
    return score(label, silent)


def _cell(share: Mapping[str, Any], *, wrong: bool) -> str:
    right = share["of"] - share["count"] if wrong else share["count"]
    return f"{right} of {share['of']}"


def wrong_cases(out: Path, told: Sequence[Mapping[str, Any]], part: str) -> Iterator[str]:
    """A line for each case whose answer is wrong."""
    for label in told:
        folder = out / part / label["name"]
        if not (folder / SECONDS).exists():
            continue
        scored = _score(label, folder, out)
        if not scored["right"]:
            seconds = json.loads((folder / SECONDS).read_text())
            yield (
                f"{label['name']} {scored['rig']} {scored['kind']} {scored['size']} {scored['drive']}: "
                f"{', '.join(scored['truth']) or 'nothing'} -> {scored['verdict']} {', '.join(scored['named'])}, "
                f"{seconds:.0f} s"
            )


def main() -> None:
    """Draw, diagnose, tell."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--cases", type=int, default=100)
    parser.add_argument("--first", type=int, help="diagnose only so many of them, a fair sample")
    parser.add_argument("--but", nargs="*", default=[], help="cases that are left out, such as case_001")
    parser.add_argument("--rig", default="all", help="as of hydrolek challenge")
    parser.add_argument("--without", nargs="+", choices=list(WITHOUT), default=list(WITHOUT))
    parser.add_argument("--part", default="1/1", help="1/2: every other case from the first")
    parser.add_argument("--at-most", type=float, default=450.0, help="seconds of processor time a case")
    parser.add_argument("--table", action="store_true", help="only tell what is known")
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    told = drawn(given.out, rig_names(given.rig), given.cases, given.seed)[: given.first]
    told = [label for label in told if label["name"] not in given.but]
    first, parts = (int(each) for each in given.part.split("/"))
    for part in () if given.table else given.without:
        for label in told[first - 1 :: parts]:
            folder = given.out / part / label["name"]
            if not (folder / SECONDS).exists():
                ended = run(label, folder, part, given.at_most)
                print(f"without {part}, {label['name']}: {ended}", flush=True)
    print(table(given.out, told, given.without))
    for part in given.without:
        print(f"\nwithout {part}, wrong:", *wrong_cases(given.out, told, part), sep="\n")


if __name__ == "__main__":
    main()
