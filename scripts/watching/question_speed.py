"""Processor time of one question: recordings of the bench, each asked against a reference that was fitted before.

python scripts/watching/question_speed.py --out out/question_speed [--repeats 3] [--profile]

Machines of the challenge (equations and an integrator of their own), 40 s each: healthy, and with one effect of the
size of the challenge's `sizes.yaml`. The reference, three recordings, is fitted once and kept. Told are processor time
and time by the clock (the least of some repeats, in which other programs count least), and what is found.
"""

import argparse
import cProfile
import json
import pstats
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from hydrolek_drake.challenge.build import BENCH, build_of
from hydrolek_drake.challenge.cases import driven, with_concealed, write_played
from hydrolek_drake.challenge.drawing import SIZING_STEP_S, individual
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.asking import asked
from hydrolek_drake.watching.questions import read_one, usable
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.store import Store
from hydrolek_drake.watching.watch import drifts_of, key_of_all, training_of, watch

EFFECTS = (
    "",
    "cylinder.cross_port_leakage",
    "fluid.entrained_air",
    "cylinder.coulomb_friction",
    "linkage.backlash",
)
SEEDS = (1, 2)


def recorded(build, machine, seed, seconds, path):
    """Write one recording."""
    rng = np.random.default_rng(seed)
    done = driven(build, machine, "open", seconds, rng, build.noise, SIZING_STEP_S)
    write_played(path, build, done, rng)


def record_all(folder, seconds, references):
    """The reference recordings, and one of each effect and seed."""
    build, rng = build_of(load_rig(BENCH)), np.random.default_rng(0)
    healthy = build.nominal._replace(**individual(build, rng))
    folder.mkdir(parents=True, exist_ok=True)
    for number in range(references):
        recorded(build, healthy, 100 + number, seconds, folder / f"reference_{number}.csv")
    for effect in EFFECTS:
        machine = with_concealed(healthy, {effect: build.listed[effect]["size"]}) if effect else healthy
        for seed in SEEDS:
            recorded(build, machine, seed, seconds, folder / f"{effect or 'healthy'}_{seed}.csv")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=40.0)
    parser.add_argument("--references", type=int, default=3)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--cores", type=int, default=2)
    parser.add_argument("--only", default="", help="part of a recording's name")
    parser.add_argument("--profile", action="store_true")
    given = parser.parse_args()
    runs = given.out / "runs"
    if not (runs / "reference_0.csv").exists():
        record_all(runs, given.seconds, given.references)
    rig, reference = load_rig(BENCH), sorted(runs.glob("reference_*.csv"))
    watch(rig, reference, [], folder=given.out / "kept", cores=given.cores)
    training = training_of(rig, reference)
    drifts = drifts_of(None)
    kept = Store(given.out / "kept", key_of_all(rig, training, drifts)).reference()
    files = sorted(
        path for path in runs.glob("*.csv") if "reference" not in path.name and given.only in path.name
    )
    with threadpool_limits(limits=1, user_api="blas"), ThreadPoolExecutor(given.cores) as pool:
        session = Session(
            rig, [e for each in training for e in each.experiments], pool, given.cores, drifts, kept[0]
        )
        for path in files:
            spent, clock = [], []
            for _ in range(given.repeats + 1):  # the first one loads machine code
                begun, at = time.process_time(), time.monotonic()
                answer = asked(session, usable(rig, read_one(rig, path)))
                spent.append(time.process_time() - begun)
                clock.append(time.monotonic() - at)
            first = answer.effects[0]
            seconds = [round(min(each[1:]), 2) for each in (spent, clock)]
            print(
                json.dumps([path.stem, *seconds, first.effect, first.size, first.low, first.high]), flush=True
            )
        if given.profile:
            with cProfile.Profile() as profile:
                for path in files:
                    asked(session, usable(rig, read_one(rig, path)))
            pstats.Stats(profile).sort_stats("cumulative").print_stats(60)


if __name__ == "__main__":
    main()
