"""Diagnoses of real machines against what their authors published."""

import json
from pathlib import Path

import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.rigs import load_rig

SHARED = Path(__file__).parents[3] / "shared" / "recordings"

pytestmark = [
    pytest.mark.shared_recordings,
    pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there"),
    pytest.mark.long("takes minutes"),
]


def test_of_the_crane_all_that_its_authors_left_out_is_named(tmp_path) -> None:
    file, out = SHARED / "patu_crane" / "patu_crane_100hz.csv", tmp_path / "patu"
    assert run(["diagnose", "patu_lift", str(file), "--between", "5", "21", "--out", str(out)]) == 0
    report = json.loads((out / "report.json").read_text())
    found = {effect["id"]: effect["parameters"] for effect in report["effects"]}
    assert {"valve.asymmetric_overlap", "supply.pressure_droop"} < set(found)
    assert {"cylinder.coulomb_friction", "cylinder.stribeck_friction"} & set(found)
    rig = load_rig("patu_lift")
    shift = found["valve.asymmetric_overlap"]["shift_m"]["value"] / rig.value(
        "joints.lift.solenoid.full_stroke"
    )
    neutral = rig.value("joints.lift.command.neutral") - shift * rig.value(
        "joints.lift.solenoid.rated_voltage"
    )
    assert 5.7 < neutral < 5.9  # published: about 5.8 V
    fitted = load_rig(str(out / "rig_fitted.yaml"))
    recording = read_recording(file, fitted.columns)
    angle = next(c for c in compare(replay(fitted, recording, (5.0, 21.0))) if c.key == "lift.angle")
    assert angle.rms < 0.0323  # rad: the published 1.85 deg
