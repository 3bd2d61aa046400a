"""Controllers in the loop of the full Diagram: agreement with the compiled loop, and failures."""

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.closed_loop import loop_on_rollout
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.station.step_sizes import StepSizes

JOINT = "right_j2"


@pytest.fixture(scope="module")
def rig():
    return load_rig(f"hydrolek_{JOINT}")


@pytest.fixture(scope="module")
def setting(rig):
    return rig_setting(rig, JOINT)


@pytest.mark.parametrize("name", ("pip_idz_c", "feedforward"))
def test_diagram_and_compiled_loop_agree(rig, setting, name):
    wanted = np.full(60, 40.0)
    law = build_law(name, setting, noisy=False)
    diagram = run_controlled(rig, {JOINT: law}, wanted[:, np.newaxis], 0.05)
    plain = loop_on_rollout(law, rig.records(), wanted, 0.05, rows_per_sample=1, longest_step=5e-4)
    assert np.max(np.abs(diagram.angle_deg[:, 0] - plain.angle_deg[: len(diagram.angle_deg)])) < 0.5
    assert diagram.angle_deg[-1, 0] == pytest.approx(plain.angle_deg[len(diagram.angle_deg) - 1], abs=0.3)


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
