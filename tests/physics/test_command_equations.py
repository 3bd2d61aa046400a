"""Calibration (4.2), (4.3), and the way from a recorded voltage to the amplifier."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.command import (
    CALIBRATED,
    calibrated_voltages,
    drive_voltage,
    ramped,
    transport_delay,
)
from hydrolek_drake.physics.records import JOINT
from hydrolek_drake.systems.operator_computer import channel_places


@pytest.fixture(scope="module")
def calibrated():
    """A joint with the four calibration coefficients A, B, C, D of (4.2), (4.3)."""
    joint = np.zeros(1, JOINT)
    joint["command"]["variant"] = CALIBRATED
    for name, value in zip("abcd", (1.3, 7.9, 1.7, 8.3), strict=True):
        joint["command"][f"calibration_{name}"] = value
    return joint[0]


@pytest.mark.parametrize(
    ("signal", "expected"),
    [
        (37.0, (1.3 + 37 * (7.9 - 1.3) / 100, 0.0)),
        (-61.0, (0.0, 1.7 + 61 * (8.3 - 1.7) / 100)),
        (0.0, (0.0, 0.0)),
        (100.0, (7.9, 0.0)),
        (-100.0, (0.0, 8.3)),
    ],
)
def test_calibration_is_equations_4_2_and_4_3(calibrated, signal, expected):
    assert_allclose(calibrated_voltages(signal, calibrated), expected, rtol=1e-14)


@pytest.mark.parametrize(("signal", "expected"), [(130.0, (7.9, 0.0)), (-1e4, (0.0, 8.3))])
def test_calibration_is_not_driven_beyond_its_full_signal(calibrated, signal, expected):
    assert_allclose(calibrated_voltages(signal, calibrated), expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("command", "expected"), [(6.0, 0.0), (4.1, 1.9), (7.3, -1.3), (1.0, 3.0), (11.0, -3.0)]
)
def test_drive_voltage_counts_from_neutral_with_polarity_and_limit(crane_joint, command, expected):
    assert_allclose(drive_voltage(command, crane_joint), expected, rtol=1e-14)


def test_transport_delay_is_the_rig_s_plus_the_effect_s(bench_joint):
    joint = bench_joint({"command.delay": 0.017, "effects.command.delay.delay_s": 0.09})
    assert_allclose(transport_delay(joint), 0.107, rtol=1e-14)


def test_channels_are_counted_through_the_modules_as_table_3_1_does():
    """Thesis 3.3.1: to move joint 5 of the right arm upwards, a signal goes to module 4, channel 0."""
    records = np.zeros(3, JOINT)
    records["command"]["module"] = 3, 4, 5  # right J2, right J5, left J4
    records["command"]["channel_a"] = 2, 0, 5
    records["command"]["channel_b"] = 3, 1, 4
    towards_a, towards_b = channel_places(records, first_module=3)
    assert towards_a.tolist() == [2, 8, 21]
    assert towards_b.tolist() == [3, 9, 20]


@pytest.mark.parametrize(
    ("h", "reached", "mean"),
    [
        (0.1, -3.0 + 5.0, -3.0 + 2.5),  # on its way: 50 V/s
        (0.16, 5.0, 1.0),  # just there
        (0.4, 5.0, (0.16 * 1.0 + 0.24 * 5.0) / 0.4),
    ],
)
def test_a_ramp_takes_its_time_for_every_volt(bench_joint, h, reached, mean):
    joint = bench_joint({"command.ramp": 0.015})
    assert_allclose(ramped(-3.0, 5.0, h, 0.005, joint), (reached, mean), rtol=1e-13)


def test_a_ramp_in_many_steps_is_the_ramp_in_one(bench_joint):
    joint = bench_joint({"command.ramp": 0.02})
    u, means = 4.0, []
    for _ in range(7):
        u, mean = ramped(u, -6.0, 0.03, 0.0, joint)
        means.append(mean)
    assert_allclose((u, np.mean(means)), ramped(4.0, -6.0, 0.21, 0.0, joint), rtol=1e-13)


def test_without_a_ramp_the_voltage_is_there_at_once(bench_joint):
    assert ramped(-3.0, 5.0, 1e-4, 0.0, bench_joint()) == (5.0, 5.0)
