"""The nominal model: what it is made of, and that it reaches the noise of a healthy machine."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.challenge.cases import read_case, record
from hydrolek_drake.diagnosis.diagnosis import _nominal, diagnose
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import load_rig

VANE = {
    "name": "case_022",
    "rig": "hydrolek_left_j4",
    "kind": "healthy",
    "size": "",
    "drive": "closed",
    "pressures": True,
    "seed": 1686633228,
    "effects": {},
    "unlisted": {},
    "shows": {},
    "stages": [],
    "machine": {
        "area_max_a": 1.1285617980006277e-06,
        "area_max_b": 1.4241333498321101e-06,
        "bulk": 988633490.8662823,
        "c_cyl": 14.525818956581757,
        "i_max_a": 0.8888762676135277,
        "i_max_b": 0.9446455316638552,
        "p_s": 15012598.56932157,
        "t_d": 0.21237886158604782,
        "w_a": 0.00021815556137565065,
        "w_b": 0.00012936089325448567,
        "x_o_a": 5.361692298850081e-05,
        "x_o_b": 6.954173404831512e-05,
    },
}


@pytest.mark.long("takes half a minute")
def test_a_healthy_vane_under_control_is_led_to_the_noise(tmp_path) -> None:
    """Case 22 of the challenge's seed 330."""
    rig = load_rig(VANE["rig"])
    record(rig, read_case(VANE), tmp_path)
    train, holdout = (read_recording(tmp_path / f"{side}.csv", rig.columns) for side in ("train", "holdout"))
    with ThreadPoolExecutor(2) as pool:
        done = diagnose(rig, [train], [holdout], pool)
    assert done.verdict == "none"


@pytest.mark.parametrize(
    ("name", "nominal"), [("emps", set()), ("emps_published", {"load.coulomb_friction", "load.offset_force"})]
)
def test_an_effect_that_is_off_is_searched_and_not_part_of_the_nominal_model(name: str, nominal: set) -> None:
    rig = load_rig(name)
    assert any("sensor.drift" in path for path in rig.free_parameters())  # its range bounds the search
    time = np.linspace(0.0, 2.0, 201)
    signals = {"axis.command": np.sin(time), "axis.position": np.sin(time)}
    driven = experiments_of(rig, Recording("made", time, signals, Path("made.csv")))
    found = {
        p.path.split(".effects.")[1].rpartition(".")[0] for p in _nominal(rig, driven) if "effects" in p.path
    }
    assert found == nominal
    searched = {c.id for c in candidates_of(rig, "axis", natural_scales(rig, "axis", driven))}
    assert "sensor.drift" in searched and not nominal & searched
