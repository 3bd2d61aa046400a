"""Concealed machines watched over a series of recordings each: what is alarmed, when, and how fast it is said to grow.

python scripts/watch_study.py --seed 61 --machines 10 --out out/watch_study

Machines are the challenge's (equations and integrator of their own). Three of ten stay healthy, one has physics in no
list, the others one listed effect which begins on some day and grows by the same every day. The labels' hash is printed
before anything is watched. What was done is kept in `--out`; the same command goes on.
"""

import argparse
import hashlib
import json
import math
import time
from pathlib import Path

import numpy as np

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.challenge.cases import driven, with_concealed
from hydrolek_drake.challenge.drawing import INDIVIDUAL, SIZING_STEP_S
from hydrolek_drake.challenge.driving import SAMPLE_S
from hydrolek_drake.files import write_whole
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.results import write_watch
from hydrolek_drake.watching.watch import watch

DAY_S = 86400.0
LATEST_ONSET = 6
"""An effect begins on the third day at the earliest and on this one at the latest, so that there is much to see."""


def labels(build, machines, recordings, seed):
    """What is concealed in each machine, drawn at random."""
    rng = np.random.default_rng(seed)
    names = [name for name, entry in build.listed.items() if not entry.get("weakens")]
    names = [names[i] for i in rng.permutation(len(names))]
    strange = list(build.unlisted)
    kinds = ["healthy"] * round(0.3 * machines) + ["unlisted"] * round(0.1 * machines)
    kinds = [*kinds, *["listed"] * (machines - len(kinds))]
    found = []
    for number, kind in enumerate(rng.permutation(kinds)):
        own = {
            f: build.rig.value(path) * float(rng.uniform(1 - INDIVIDUAL, 1 + INDIVIDUAL))
            for f, path in build.spread.items()
        }
        name, entry = "", {}
        if kind == "listed":
            name = names[number % len(names)]
            entry = build.listed[name]
        elif kind == "unlisted":
            name = next(n for n in rng.permutation(strange) if not build.unlisted[n].get("weakens"))
            entry = build.unlisted[name]
        drawn = {p: float(math.exp(rng.uniform(*np.log(e)))) for p, e in entry.get("draw", {}).items()}
        last = float(rng.uniform(0.5, 2.0))
        found.append(
            {
                "kind": str(kind),
                "effect": str(name),
                "onset": int(rng.integers(2, LATEST_ONSET)),
                "at_last": {p: last * v for p, v in entry.get("size", {}).items()},
                "drawn": drawn,
                "machine": own,
                "seed": int(rng.integers(2**31)),
                "recordings": recordings,
            }
        )
    return found


def record(build, label, folder, seconds):
    """Write three reference recordings and one a day."""
    rng = np.random.default_rng(label["seed"])
    healthy = build.nominal._replace(**label["machine"])
    noise, resolution = (build.rig.value(f"sensor.{name}") for name in ("noise", "resolution"))
    folder.mkdir(parents=True, exist_ok=True)
    days = label["recordings"]
    for number in range(-3, days):
        machine = healthy
        if label["effect"] and number > label["onset"]:
            share = (number - label["onset"]) / (days - 1 - label["onset"])
            sizes = {p: share * v for p, v in label["at_last"].items()} | label["drawn"]
            machine = with_concealed(healthy, {label["effect"]: sizes})
        done = driven(build, machine, "open", seconds, rng, noise, SIZING_STEP_S)
        reading = done.reading + noise * rng.standard_normal(done.reading.size)
        name = f"reference_{number + 3}.csv" if number < 0 else f"run_2026-03-{number + 1:02d}.csv"
        signals = {"joint.command": done.volts, "joint.angle": np.round(reading / resolution) * resolution}
        units = {"joint.command": "V", "joint.angle": "rad"}
        write_signals(folder / name, np.arange(done.volts.size) * SAMPLE_S, signals, units)


def row_of(label, watched, seconds):
    """How a machine was told."""
    alarm = watched.alarm
    row = {
        "kind": label["kind"],
        "planted": label["effect"],
        "onset": label["onset"] + 1 if label["effect"] else None,
        "named": alarm.effect if alarm else "",
        "as_well": list(alarm.as_well) if alarm else [],
        "since": alarm.since if alarm else None,
        "unlisted": bool(alarm and alarm.unlisted),
        "inflation": watched.healthy.inflation,
        "seconds_a_recording": seconds / max(watched.anew, 1),
    }
    if alarm and label["kind"] == "listed" and alarm.effect == label["effect"] and alarm.joint:
        days = label["recordings"] - 1 - label["onset"]
        [size, *_] = label["at_last"].values()
        trend = watched.trend(alarm.effect, alarm.joint)
        if trend.last is not None:
            row["growth_over_planted"] = trend.last.slope * DAY_S / (size / days)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=61)
    parser.add_argument("--machines", type=int, default=10)
    parser.add_argument("--recordings", type=int, default=12)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    build = build_of(load_rig("joint_bench"))
    drawn = labels(build, given.machines, given.recordings, given.seed)
    text = json.dumps(drawn, sort_keys=True, indent=1)
    given.out.mkdir(parents=True, exist_ok=True)
    write_whole(given.out / "labels.json", text)
    print("labels", hashlib.sha256(text.encode()).hexdigest(), flush=True)
    rows = []
    for number, label in enumerate(drawn):
        folder = given.out / f"machine_{number:02d}"
        if not (folder / "whole").exists():
            record(build, label, folder, given.seconds)
            write_whole(folder / "whole", "")
        begun = time.process_time()
        reference, later = (sorted(folder.glob(each)) for each in ("reference_*.csv", "run_*.csv"))
        watched = watch(build.rig, reference, later, folder=folder / "out", cores=2)
        write_watch(watched, folder / "out")
        rows.append(row_of(label, watched, time.process_time() - begun))
        print(json.dumps(rows[-1]), flush=True)
        write_whole(given.out / "study.json", json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
