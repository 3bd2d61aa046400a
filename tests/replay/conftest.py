"""Machines and recordings of the joint bench."""

import json
from pathlib import Path

import pytest

from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

ROOT = Path(__file__).parents[2]
BENCH = ROOT / "tests" / "data" / "bench"
_PATHS = {
    "A_max_m2": ("valve.max_area_a", "valve.max_area_b"),
    "x_o_m": ("valve.overlap_a", "valve.overlap_b"),
    "w_m": ("valve.full_opening_a", "valve.full_opening_b"),
    "P_S_Pa": ("supply.pressure",),
    "B_Pa": ("fluid.bulk_modulus",),
    "c_cyl_N_s_per_m": ("cylinder.viscous_friction",),
    "J_kg_m2": ("load.inertia",),
    "mgl_Nm": ("load.gravity_cos",),
    "I_max_A": ("amplifier.max_current_a", "amplifier.max_current_b"),
    "T_d_s": ("command.delay",),
}


@pytest.fixture(scope="session")
def labelled_rig():
    """The bench with the parameters, and if wanted the effects, that a practice pair was made with."""
    labels = {label["id"]: label for label in json.loads((BENCH / "practice_labels.json").read_text())}

    def rig(name, effects=False):
        label = labels[name]
        values = {path: label["machine"][key] for key, paths in _PATHS.items() for path in paths}
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
