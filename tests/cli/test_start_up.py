"""A mistake is answered before anything that computes is loaded: seconds of processor time are spared."""

import json
import subprocess
import sys

import pytest

HEAVY = (
    "scipy.optimize",
    "scipy.stats",
    "pydrake",
    "numba",
    "cv2",
    "pymoo",
    "matplotlib",
    "plotly",
    "control",
)
"""Packages that take 0.2 s or more of processor time to load."""

_PROGRAM = """
import json, sys
from hydrolek_drake.cli.app import run
status = run(sys.argv[1:])
print("loaded", json.dumps([status, sorted(sys.modules)]), file=sys.stderr)
"""


def _loaded(arguments):
    done = subprocess.run(
        [sys.executable, "-c", _PROGRAM, *arguments], capture_output=True, text=True, timeout=60.0, check=True
    )
    status, modules = json.loads(done.stderr.rpartition("loaded ")[2])
    return status, {name for name in HEAVY if name in modules}


@pytest.mark.parametrize("arguments", [["--help"], ["diagnose", "--help"], ["fit", "--help"], ["nonsense"]])
def test_help_and_unknown_commands_load_nothing_that_computes(arguments):
    status, heavy = _loaded(arguments)
    assert status == (2 if arguments == ["nonsense"] else 0) and not heavy


@pytest.mark.parametrize(
    "arguments",
    [
        ["replay", "joint_bench", "nowhere.csv"],
        ["replay", "nowhere", "nowhere.csv"],
        ["fit", "joint_bench", "nowhere.csv"],
        ["fit", "joint_bench", "nowhere.csv", "--method", "annealing"],
        ["fit", "joint_bench", "a.csv", "a.csv"],
        ["diagnose", "joint_bench", "nowhere.csv"],
        ["diagnose", "joint_bench", "nowhere.csv", "--workers", "0"],
        ["sensitivity", "joint_bench", "nowhere.csv"],
        ["sensitivity", "joint_bench", "--sobol", "3"],
        ["identify", "two-step", "joint_bench", "nowhere.csv"],
        ["identify", "force", "emps", "nowhere.csv"],
        ["simulate", "nowhere.yaml"],
        ["control", "bench", "--controller", "magic"],
        ["control", "judge", "--controller", "magic"],
        ["control", "design", "nowhere"],
        ["challenge", "--cases", "0"],
        ["watch", "joint_bench", "nowhere.csv", "--recordings", "."],
        ["watch", "joint_bench", "a.csv", "--recordings", ".", "--false-alarms", "2"],
        ["teleop", "--plant", "steam"],
        ["teleop", "--stand", "nowhere.json"],
        ["serve", "--plant", "steam"],
        ["stand", "nowhere.yaml"],
        ["stand", "--base", "nowhere.yaml"],
        ["stand", "--grasp", "0.1", "--cut", "0.1"],
        ["carry", "--controller", "magic"],
    ],
    ids=" ".join,
)
@pytest.mark.thorough(but=8)
def test_bad_input_is_answered_before_anything_that_computes_is_loaded(arguments):
    status, heavy = _loaded(arguments)
    assert status == 2 and heavy <= {"numba"}  # effects are declared beside their compiled functions


@pytest.mark.parametrize("arguments", [["rigs"], ["effects"], ["rigs", "joint_bench"]], ids=" ".join)
def test_lists_load_nothing_that_computes(arguments):
    status, heavy = _loaded(arguments)
    assert status == 0 and heavy <= {"numba"}
