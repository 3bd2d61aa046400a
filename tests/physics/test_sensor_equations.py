"""Potentiometer (3.1)-(3.3) against Table 3.2; play of the reading."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics import sensor
from hydrolek_drake.physics.records import JOINT

# Table 3.2: V_min, V_max [V], D_min, D_max [deg], printed V_0 [V] and alpha [V/deg]; the rows whose printed
# scaling follows from their own range (docs/reference/thesis_errata.md lists the others)
AGREEING = {
    "right J1": (3.71, 11.43, -27.0, 40.6, 6.792, 0.114),
    "right J2": (1.11, 13.54, -10.3, 65.6, 2.794, 0.164),
    "left J2": (4.69, 13.59, -10.3, 65.6, 5.901, 0.117),
    "left J3": (2.92, 12.24, -42.0, 21.4, 9.091, 0.147),
    "left J4": (2.33, 13.67, -114.0, 63.9, 9.596, 0.064),
}
CONTRADICTING = {
    "right J3": (2.92, 12.24, -42.0, 21.4, 7.024, 0.144),
    "right J4": (2.33, 13.67, -114.0, 63.9, 5.767, 0.064),
    "right J5": (7.75, 23.52, -81.5, -4.16, 6.902, 0.204),
    "left J1": (6.39, 12.99, -40.6, 27.0, 10.77, 0.108),
    "left J5": (1.91, 12.63, -81.5, -4.16, 1.33, 0.139),
}


def _scaling(v_min, v_max, d_min, d_max):
    alpha = sensor.volts_per_degree(v_min, v_max, d_min, d_max)
    return sensor.zero_voltage(v_min, d_min, alpha), alpha


@pytest.mark.parametrize("row", AGREEING.values(), ids=AGREEING.keys())
def test_equations_3_1_and_3_2_give_table_3_2(row):
    *limits, printed_zero, printed_alpha = row
    zero, alpha = _scaling(*limits)
    assert_allclose(alpha, printed_alpha, atol=0.0005)  # printed to 0.001 V/deg
    # printed from a rounded alpha, whose half unit is worth up to D_min times 0.0005 V, and rounded itself
    assert_allclose(zero, printed_zero, atol=0.0005 * abs(limits[2]) + 0.0005)


@pytest.mark.parametrize("row", CONTRADICTING.values(), ids=CONTRADICTING.keys())
def test_rows_listed_as_contradicting_themselves_do(row):
    *limits, printed_zero, printed_alpha = row
    zero, alpha = _scaling(*limits)
    agrees = (
        abs(alpha - printed_alpha) <= 0.0005 and abs(zero - printed_zero) <= 0.0005 * abs(limits[2]) + 0.0005
    )
    assert not agrees


@pytest.mark.parametrize("row", AGREEING.values(), ids=AGREEING.keys())
def test_equation_3_3_reads_the_limits_at_the_limit_voltages_and_turns_round(row):
    v_min, v_max, d_min, d_max = row[:4]
    joint = np.zeros(1, JOINT)
    joint["sensor"]["zero_voltage"], joint["sensor"]["volts_per_degree"] = _scaling(
        v_min, v_max, d_min, d_max
    )
    assert_allclose(sensor.angle_from_voltage(v_min, joint[0]), d_min, rtol=1e-12)
    assert_allclose(sensor.angle_from_voltage(v_max, joint[0]), d_max, rtol=1e-12)
    angle = 11.3
    volts = sensor.potentiometer_voltage(angle, joint[0])
    assert_allclose(sensor.angle_from_voltage(volts, joint[0]), angle, rtol=1e-12)


def test_play_of_the_reading_is_the_play_operator(bench_joint):
    half = 0.01
    joint = bench_joint({"effects.sensor.hysteresis.half_width_rad": half})
    held, path = 0.0, []
    for position in (0.0, 0.008, 0.03, 0.05, 0.045, 0.031, 0.02, -0.04, -0.035):
        held = sensor.played(held, position, joint)
        path.append(held)
    assert_allclose(path, [0.0, 0.0, 0.02, 0.04, 0.04, 0.04, 0.03, -0.03, -0.03], atol=1e-15)


def test_reading_of_a_healthy_sensor_is_the_position(bench_joint):
    joint = bench_joint()
    assert sensor.reading(sensor.played(0.2, 0.37, joint), 17.0, joint) == 0.37
