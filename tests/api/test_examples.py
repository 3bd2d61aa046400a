"""The examples of docs/examples, run as they stand but on less data."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hydrolek_drake.recordings import read_recording, write_recording

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "tests" / "data" / "bench"


def _short(case, folder, seconds):
    path = folder / f"{case}.csv"
    write_recording(read_recording(BENCH / case / "train.csv").between(0.0, seconds), path)
    return path


def _run(name, *arguments, cwd):
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}
    done = subprocess.run(
        [sys.executable, str(ROOT / "docs" / "examples" / f"{name}.py"), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=180.0,
        cwd=cwd,
        env=environment,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.mark.parametrize(
    ("name", "case", "seconds", "said"),
    [
        ("replay", "practice_01", 12.0, "joint.angle"),
        pytest.param("fit", "practice_01", 6.0, "supply.pressure", marks=pytest.mark.thorough),
        pytest.param(
            "own_machine",
            "practice_01",
            8.0,
            "after: joint.angle: model and recording agree to the noise",
            marks=pytest.mark.thorough,
        ),
        pytest.param("diagnose", "practice_02", 8.0, "none", marks=pytest.mark.long("half a minute")),
    ],
)
def test_example(name, case, seconds, said, tmp_path):
    assert said in _run(name, _short(case, tmp_path, seconds), cwd=tmp_path)


def test_example_of_a_watch(tmp_path):
    later = tmp_path / "later"
    later.mkdir()
    whole = read_recording(BENCH / "practice_01" / "train.csv")
    reference = tmp_path / "reference.csv"
    write_recording(whole.between(0.0, 12.0), reference)
    worn = read_recording(BENCH / "practice_03" / "train.csv")  # another machine, and it leaks
    for day in (1, 2):
        write_recording(worn.between(0.0, 10.0 + day), later / f"run_2026-03-0{day}.csv")
    out = _run("watch", reference, later, cwd=tmp_path)
    assert "alarm:" in out and "Limit" in out
    assert (tmp_path / "out" / "watch" / "watch.html").exists()
