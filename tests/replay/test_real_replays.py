"""Replays of real machines against published and checked errors."""

from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.recordings import read_recording
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.rigs import load_rig

SHARED = Path(__file__).parents[3] / "shared" / "recordings"

pytestmark = [
    pytest.mark.shared_recordings,
    pytest.mark.skipif(not SHARED.is_dir(), reason="the folder ../shared/recordings is not there"),
]


def _compared(rig_name, file):
    rig = load_rig(rig_name)
    return {c.key: c for c in compare(replay(rig, read_recording(SHARED / file, rig.columns)))}


@pytest.mark.parametrize(
    ("file", "rms_mm"), [("emps_estimation.csv", 6.3), ("emps_test_pulses.csv", 8.9), ("DATA_EMPS.mat", 6.3)]
)
def test_emps_with_published_friction_errs_as_published(file, rms_mm):
    axis = _compared("emps_published", f"emps/{file}")["axis.position"]
    assert 1e3 * axis.rms == pytest.approx(rms_mm, rel=0.10)


@pytest.mark.parametrize("file", ["emps_estimation.csv", "emps_test_pulses.csv"])
def test_emps_without_dry_friction_errs_by_far_more(file):
    """Open loop: an unbalanced force integrates twice, so that 20 N left out make more than 100 mm."""
    axis = _compared("emps", f"emps/{file}")["axis.position"]
    assert 1e3 * axis.rms > 100.0
    assert not axis.agrees


def test_patu_with_symmetric_dead_band_errs_when_lowering_too():
    """Published is that the nominal 6 V neutral does not fit: the symmetric model must be far off."""
    compared = _compared("patu_lift", "patu_crane/patu_crane_100hz.csv")
    assert set(compared) == {"lift.angle", "lift.pressure_a", "lift.pressure_b", "supply.pressure"}
    angle = compared["lift.angle"]
    assert np.degrees(angle.rms) > 4.84  # what the authors' own model leaves over 0-40 s
    assert not angle.agrees
    assert angle.conditions[0].name == "while moving in the negative direction"
    # pump pressure was recorded from 5 to 32 s only
    assert compared["supply.pressure"].samples < angle.samples


def test_festo_with_viscous_friction_errs_in_pressure():
    compared = _compared("festo_tp511", "servo_hydraulic_cylinder_festo_tp511/steps_3V_repeat1_1khz.csv")
    assert set(compared) == {"cylinder.position", "cylinder.pressure_a"}
    assert not any(c.agrees for c in compared.values())
