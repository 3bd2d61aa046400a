"""Whole commands with machines in lanes, and one by one, in one run."""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.rollout.lanes.lanes import OFF, SWITCH

_MAIN = "from hydrolek_drake.cli.app import main; main()"
TRAINING, HELD_OUT = "train.csv", "holdout.csv"


@dataclass(frozen=True)
class CommandSpeed:
    """How long a command takes: processor time of all its processes, and time by the clock [s].

    Attributes:
        name: what it does.
        in_lanes: processor time.
        in_lanes_clock: by the clock.
        one_by_one: the same, with machines rolled out one after the other.
        one_by_one_clock: by the clock.
    """

    name: str
    in_lanes: float
    in_lanes_clock: float
    one_by_one: float
    one_by_one_clock: float


def measure_commands(pairs: Path, report: Callable[[str], None]) -> list[CommandSpeed]:
    """Fits and diagnoses of the bench, each as a user would start it.

    Args:
        pairs: folder of `practice_NN`, each with `train.csv` and `holdout.csv`.
        report: told what is measured next.

    Raises:
        InputError: no such folder, or a command that fails.
    """
    found = sorted(pair for pair in pairs.glob("practice_*") if (pair / TRAINING).exists())
    if not found:
        raise InputError(f"--pairs {pairs}: no folders practice_NN with {TRAINING} and {HELD_OUT} in it")
    first = str(found[0] / TRAINING)
    works = [
        (
            f"fit of {found[0].name}, de, 2000 evaluations, two workers",
            [
                "fit",
                "joint_bench",
                first,
                "--method",
                "de",
                "--budget",
                "2000",
                "--workers",
                "2",
                "--no-confirm",
            ],
        ),
        (f"fit of {found[0].name}, least squares", ["fit", "joint_bench", first, "--no-confirm"]),
    ]
    for pair in found:
        given = [str(pair / TRAINING), "--holdout", str(pair / HELD_OUT)]
        works.append((f"diagnosis of {pair.name}", ["diagnose", "joint_bench", *given, "--no-confirm"]))
    rows = []
    for name, arguments in works:
        report(name)
        rows.append(CommandSpeed(name, *_seconds(arguments, {}), *_seconds(arguments, {SWITCH: OFF})))
    return rows


def _seconds(arguments: list[str], environment: dict[str, str]) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-c", _MAIN, *arguments, "--out", out]
        before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
        done = subprocess.run(command, env={**os.environ, **environment}, capture_output=True, text=True)
        clock, after = time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise InputError(
            f"{' '.join(arguments)}: exit status {done.returncode}: {done.stderr.strip()[-200:]}"
        )
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, clock
