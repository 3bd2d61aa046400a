"""Controllers in the loop of the full Diagram: agreement with the compiled loop, and failures."""

import sys
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.station.step_sizes import StepSizes

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts"))
import agreement  # the study that docs/evidence/agreement.md records

JOINT = "right_j2"


@pytest.fixture(scope="module")
def rig():
    return load_rig(f"hydrolek_{JOINT}")


@pytest.fixture(scope="module")
def setting(rig):
    return rig_setting(rig, JOINT)


def test_signals_are_those_of_the_control_samples_whatever_the_diagram_is_to_log(rig, setting):
    law, wanted = build_law("pip_idz_c", setting, noisy=False), np.full((40, 1), 40.0)
    runs = [
        run_controlled(rig, {JOINT: law}, wanted, 0.05, sizes=StepSizes(log_period=period))
        for period in (0.01, 0.05)
    ]
    np.testing.assert_array_equal(runs[0].angle_deg, runs[1].angle_deg)
    np.testing.assert_array_equal(runs[0].voltage_V, runs[1].voltage_V)
    assert runs[0].angle_deg[-1, 0] == pytest.approx(40.0, abs=3.0)


@pytest.mark.parametrize("name", ("pi", "pid", "pip_idz_b", "feedforward"))
@pytest.mark.thorough(but=1)
def test_when_the_supply_is_lost_the_valve_closes(rig, setting, name):
    law = build_law(name, setting, noisy=False)
    run = run_controlled(rig, {JOINT: law}, np.full((120, 1), 60.0), 0.05, supply_lost_at=0.4)
    assert np.max(np.abs(run.voltage_V[:8])) > 1.0
    assert np.all(run.voltage_V[-30:] == 0.0)


def test_a_withdrawn_set_point_closes_the_valve_of_the_machine(rig, setting):
    wanted = np.full((60, 1), 50.0)
    wanted[10:] = np.nan
    run = run_controlled(rig, {JOINT: build_law("pip_idz_b", setting, noisy=False)}, wanted, 0.05)
    assert np.all(run.voltage_V[10:] == 0.0)
    assert abs(run.angle_deg[-1, 0] - run.angle_deg[-10, 0]) < 0.5


def test_wrong_joints_and_shapes_are_refused(rig, setting):
    law = build_law("pi", setting, noisy=False)
    with pytest.raises(InputError, match="no joint 'left_j2'"):
        run_controlled(rig, {"left_j2": law}, np.zeros((5, 1)), 0.05)
    with pytest.raises(InputError, match=r"need \(n, 1\)"):
        run_controlled(rig, {JOINT: law}, np.zeros((5, 2)), 0.05)


@pytest.mark.parametrize("joint", ("hydrolek_right_j2", "hydrolek_left_j5"))
@pytest.mark.thorough(but=1)
def test_closed_loops_agree_at_the_steps_that_are_taken_where_none_is_given(joint):
    """Half of the 0.1 deg by which controllers are judged."""
    assert max(agreement.closed(joint, agreement.CONTROLLERS)) <= 0.05


@pytest.mark.long("takes ten minutes together on a busy machine")
@pytest.mark.parametrize("joint", agreement.JOINTS)
def test_every_instrumented_joint_agrees_in_closed_loop(joint):
    """At half the step: a controller at the edge of its chatter band makes 0.5 deg of a ten-thousandth."""
    assert max(agreement.closed(joint, agreement.CONTROLLERS, 0.5e-3)) <= 0.05
