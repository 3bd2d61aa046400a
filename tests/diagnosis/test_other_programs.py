"""A machine that other people's programs simulated, its rig written from the data sheet: what is concealed is named."""

import json
from pathlib import Path

import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.rigs import load_rig

SHARED = Path(__file__).parents[3] / "shared" / "recordings" / "hopsan_link"
LEAKAGE = "cylinder.cross_port_leakage"


pytestmark = [
    pytest.mark.shared_recordings,
    pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there"),
]


@pytest.mark.long("a minute or two")
def test_a_leak_past_the_piston_is_named_with_its_size(tmp_path) -> None:
    arguments = ["hopsan_link", str(SHARED / "h03_train.csv"), "--holdout", str(SHARED / "h03_holdout.csv")]
    assert run(["diagnose", *arguments, "--no-confirm", "--out", str(tmp_path)]) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    [case] = [c for c in json.loads((SHARED / "labels.json").read_text())["cases"] if c["id"] == "h03"]
    assert report["verdict"] == "missing_physics"
    [named] = report["effects"]
    assert named["id"] == LEAKAGE
    size = named["parameters"]["conductance_m3_per_s_Pa"]["value"]
    assert size == pytest.approx(case["effect"]["cleak"], rel=0.15)
    assert report["fit"]["with_effects"]["holdout_over_noise"] < 1.15


@pytest.mark.long("five minutes")
def test_a_dead_time_is_named_and_nothing_else(tmp_path) -> None:
    arguments = ["hopsan_link", str(SHARED / "h07_train.csv"), "--holdout", str(SHARED / "h07_holdout.csv")]
    assert run(["diagnose", *arguments, "--no-confirm", "--out", str(tmp_path)]) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    [case] = [c for c in json.loads((SHARED / "labels.json").read_text())["cases"] if c["id"] == "h07"]
    assert report["verdict"] == "missing_physics"
    [named] = report["effects"]
    assert named["id"] == "command.delay"
    # the rig's own dead time, which is searched too, and what came to it are one number to the recording
    own = load_rig(str(tmp_path / "rig_fitted.yaml")).value("joints.joint.command.delay")
    total = own + named["parameters"]["delay_s"]["value"]
    assert total == pytest.approx(case["effect"]["delay"], rel=0.15)
