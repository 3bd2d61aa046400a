"""Machines and recordings of the joint bench."""

import json
from pathlib import Path

import pytest

from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "tests" / "data" / "bench"
_PATHS = json.loads((BENCH / "rig_paths.json").read_text())


@pytest.fixture(scope="session")
def labelled_rig():
    """The bench with the parameters, and if wanted the effects, that a practice pair was made with."""
    labels = {label["id"]: label for label in json.loads((BENCH / "practice_labels.json").read_text())}

    def rig(name, effects=False):
        label = labels[name]
        values = {path: label["machine"][key] for key, path in _PATHS.items()}
        if effects:
            for effect, parameters in label["effects"].items():
                values |= {f"effects.{effect}.{key}": value for key, value in parameters.items()}
        return load_rig("joint_bench").with_values(values)

    return rig


@pytest.fixture(scope="session")
def bench_recording():
    def read(name, part="train"):
        return read_recording(BENCH / name / f"{part}.csv")

    return read
