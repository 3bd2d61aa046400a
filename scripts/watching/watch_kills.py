"""A watch that is killed again and again must end with the table of one that was not.

python scripts/watching/watch_kills.py --out out/kills

Sixty short recordings of a bench whose piston leaks more and more, watched once without a break, and once by commands
of which each is killed (SIGKILL, with its whole process group) after a random time, until the last one may end.
"""

import argparse
import hashlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.challenge.cases import driven, with_concealed, write_played
from hydrolek_drake.challenge.drawing import SIZING_STEP_S
from hydrolek_drake.rigs import load_rig

START = "import sys; from hydrolek_drake.cli.app import main; sys.exit(main())"
LEAKAGE = "cylinder.cross_port_leakage"
MORE = 2e-14
"""Leakage that each recording has more [m^3/(s Pa)], from the twentieth on."""


def record(folder, count, seconds):
    """Three reference recordings, and later ones whose names are days."""
    build = build_of(load_rig("joint_bench"))
    (folder / "runs").mkdir(parents=True, exist_ok=True)
    for number in range(-3, count):
        rng = np.random.default_rng((9, number + 3))
        sizes = {"conductance_m3_per_s_Pa": MORE * max(number - 19, 0)}
        machine = with_concealed(build.nominal, {LEAKAGE: sizes})
        done = driven(build, machine, "open", seconds, rng, build.noise, SIZING_STEP_S)
        name = f"reference_{number + 3}.csv"
        if number >= 0:
            name = f"runs/run_2026-{3 + number // 28:02d}-{1 + number % 28:02d}.csv"
        write_played(folder / name, build, done, rng)


def begun(folder, out):
    """The command, under way in a process group of its own."""
    reference = [str(path) for path in sorted(folder.glob("reference_*.csv"))]
    given = ["watch", "joint_bench", *reference, "--recordings", str(folder / "runs"), "--workers", "1"]
    with (folder / "said.txt").open("a") as said:
        command = [sys.executable, "-c", START, *given, "--out", str(out)]
        return subprocess.Popen(command, stdout=said, stderr=said, start_new_session=True)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--recordings", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True)
    given = parser.parse_args()
    record(given.out, given.recordings, given.seconds)
    clock = time.monotonic()
    status = begun(given.out, given.out / "whole").wait()
    clock = time.monotonic() - clock
    print(f"without a break: exit status {status}, {clock:.0f} s", flush=True)
    rng = np.random.default_rng(given.seed)
    killed = 0
    while killed < given.kills:
        process = begun(given.out, given.out / "broken")
        after = float(rng.uniform(0.0, 2.0 * clock / given.kills + 4.0))  # starting takes seconds by itself
        try:
            process.wait(after)
            break
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            killed += 1
            seen = len(list((given.out / "broken" / "seen").glob("*.json")))
            print(f"killed after {after:.2f} s: {seen} recordings are kept", flush=True)
    last = begun(given.out, given.out / "broken").wait()
    tables = [
        hashlib.sha256((given.out / name / "watch.parquet").read_bytes()).hexdigest()
        for name in ("whole", "broken")
    ]
    print(f"{killed} kills, last exit status {last}; tables {tables}, the same: {tables[0] == tables[1]}")


if __name__ == "__main__":
    main()
