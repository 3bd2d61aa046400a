"""Controllers' voltages through (4.2), (4.3) and the channels of Table 3.1: as on the machine, and nothing lost."""

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.control.laws.operator_path import through_operator_computer
from hydrolek_drake.physics.command import calibrated_voltages
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.systems.operator_computer import FieldPoint, OperatorComputer

JOINTS = ("right_j1", "left_j1")


def _through(joints, signal):
    computer, field_point = OperatorComputer(joints), FieldPoint(joints)
    context = computer.CreateDefaultContext()
    computer.signal.FixValue(context, signal)
    channels = computer.channels.Eval(context)
    context = field_point.CreateDefaultContext()
    field_point.channels.FixValue(context, channels)
    return field_point.command.Eval(context)


def test_a_voltage_comes_out_as_it_went_in_and_limited():
    rig, per_volt = through_operator_computer(load_rig("hydrolek"))
    joints = rig.records()
    volts = np.linspace(-12.0, 12.0, len(joints))
    np.testing.assert_allclose(
        _through(joints, per_volt * volts), np.clip(volts, -10.0, 10.0), rtol=1e-14, atol=1e-14
    )


@pytest.mark.parametrize("joint", JOINTS)
def test_a_scaled_input_is_4_2_with_table_6_3(joint):
    rig = load_rig("hydrolek")
    scaling, record = rig_setting(rig, joint).scaling, rig.records()[rig.joints.index(joint)]
    if record["command"]["polarity"] > 0:
        for signal in (-100.0, -40.0, 0.0, 1e-3, 55.0, 100.0):
            a, b = calibrated_voltages(signal, record)
            assert scaling.voltage(signal) == pytest.approx(a - b)


def test_a_rig_without_channels_has_no_operator_computer():
    rig = load_rig("joint_bench")
    assert through_operator_computer(rig) == (rig, None)


def test_the_channels_are_in_the_loop():
    rig = load_rig("hydrolek_right_j2")
    wanted = np.full((30, 1), 10.0)
    setting = rig_setting(rig, "right_j2")
    run = run_controlled(rig, {"right_j2": build_law("pip_idz_c", setting, noisy=False)}, wanted, 0.05)
    wired = rig.with_values({"command.channel_a": 1.0, "command.channel_b": 0.0})
    other = run_controlled(wired, {"right_j2": build_law("pip_idz_c", setting, noisy=False)}, wanted, 0.05)
    np.testing.assert_array_equal(
        run.angle_deg, other.angle_deg
    )  # computer and field point agree on the wiring
    assert run.angle_deg[-1, 0] < run.angle_deg[0, 0] - 5.0
