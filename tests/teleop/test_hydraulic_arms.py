"""Both arms with their hydraulics under controllers, stepped a sample at a time."""

import numpy as np
import pytest

from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.hydraulic_arms import JOINTS, HydraulicArms
from hydrolek_drake.workcell.scene import home_posture

SECOND = round(1.0 / sample_s())
NOISE = np.radians(0.05 * 5 + 0.02)  # five standard deviations of the sensors, and their resolution


@pytest.fixture(scope="module")
def arms():
    return HydraulicArms(home_posture())


def _settle(arms):
    for _ in range(3 * SECOND):
        arms.advance(home_posture())
    for _ in range(SECOND):
        arms.advance()


def test_with_closed_valves_the_arms_are_carried_by_the_trapped_oil(arms):
    _settle(arms)
    before = arms.position()
    for _ in range(2 * SECOND):
        arms.advance()
    np.testing.assert_allclose(arms.position(), before, atol=np.radians(0.01))
    np.testing.assert_array_equal(arms.signals().voltage, 0.0)


def test_all_joints_go_to_a_set_point_and_the_signals_are_those_of_a_moving_machine(arms):
    _settle(arms)
    wanted = 0.5 * home_posture()
    wanted[[5, 12]] = np.radians(-10.0)
    voltages, pressures = [], []
    for _ in range(4 * SECOND):
        arms.advance(wanted)
        signals = arms.signals()
        voltages.append(signals.voltage)
        pressures.append([signals.pressure_a, signals.pressure_b])
    np.testing.assert_allclose(arms.position(), wanted, atol=np.radians(0.5))  # objective of chapter 6
    assert (np.abs(voltages).max(axis=0) > 1.0).all()  # beyond every valve's dead-zone
    assert (np.ptp(pressures, axis=0) > 1e5).all()
    supply = load_rig("hydrolek").value("supply.pressure")
    assert 0.5 * supply < signals.supply_pressure <= supply


def test_a_deflection_moves_its_joint_alone_in_its_direction_until_it_is_let_go(arms):
    _settle(arms)
    for joint in (1, 7, 11):  # of the left arm's, side A turns joint 1 negative
        before = arms.position()
        deflection = np.zeros(14)
        deflection[joint] = 30.0
        for _ in range(SECOND):
            arms.advance(deflection=deflection)
        moved = np.degrees(arms.position() - before)
        assert moved[joint] > 2.0
        assert np.abs(np.delete(moved, joint)).max() < 0.3  # oil springs give way a little
        for _ in range(SECOND):
            arms.advance()
        still = arms.position()
        for _ in range(SECOND):
            arms.advance()
        np.testing.assert_allclose(arms.position(), still, atol=np.radians(0.1))


def test_potentiometers_read_by_table_3_2_and_joints_without_one_read_nothing(arms):
    records = arms.rig.records()["sensor"]
    angle, voltage = np.degrees(arms.measured()), arms.signals().potentiometer
    for i in (0, 4, 7, 11):
        expected = records["zero_voltage"][i] + records["volts_per_degree"][i] * angle[i]
        assert voltage[i] == pytest.approx(expected, abs=1e-9)
    np.testing.assert_array_equal(np.isnan(voltage), [joint[-1] in "67" for joint in JOINTS])


def test_the_logs_of_a_long_session_do_not_grow(arms):
    for _ in range(round(teleop_entries("plant")["forget_after"]) * SECOND + 5):
        arms.advance()
    context = arms._simulator.get_context()
    most = teleop_entries("plant")["forget_after"] / sample_s()
    assert all(log.FindLog(context).num_samples() <= most for log in arms.station.logs.values())


def test_the_reading_is_the_position_with_noise(arms):
    assert np.abs(arms.measured() - arms.position()).max() < NOISE


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"controller": "magic"}, "no controller 'magic'; choose pi"),
        ({"rig": "joint_bench"}, "is not both arms"),
        ({"posture": np.full(14, 2.0)}, r"right_j1 = 114\.6 deg lies outside"),
        ({"posture": np.zeros(3)}, "14 finite angles"),
    ],
)
@pytest.mark.thorough(but=1)
def test_what_cannot_be_simulated_is_refused(arguments, message):
    named = {"posture": home_posture()} | arguments
    if "rig" in named:
        named["rig"] = load_rig(named["rig"])
    with pytest.raises(InputError, match=message):
        HydraulicArms(named.pop("posture"), **named)


def test_without_a_pipe_there_is_no_force_to_control(arms):
    with pytest.raises(InputError, match="no pipe"):
        arms.advance(grip=[100.0, np.nan])
