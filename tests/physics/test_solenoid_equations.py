"""Equations (4.5), (4.6): solenoids and spool; and the spool's own integration."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.solenoid import advance, solenoid_force, spool_acceleration

M, C, K = 0.05, 60.0, 8000.0
UNEQUAL = {"solenoid.force_constant_a": 31.0, "solenoid.force_constant_b": 23.0}


def test_force_is_equation_4_5_with_the_mapping_of_its_three_constants():
    alpha, beta, gamma = 0.37, 0.11, 13.0
    current, stroke = 0.83, 0.21e-3
    assert_allclose(
        solenoid_force(current, stroke, alpha / beta**2, gamma / beta),
        alpha * current**2 / (beta + gamma * stroke) ** 2,
        rtol=1e-13,
    )


def test_force_of_a_plunger_that_is_pushed_back_is_that_at_zero_stroke():
    assert solenoid_force(0.83, -0.4e-3, 30.0, 120.0) == 30.0 * 0.83 * 0.83


@pytest.mark.parametrize("x", [0.17e-3, -0.17e-3])
def test_spool_acceleration_at_an_odd_point_is_newton_s_law(bench_joint, x):
    v, i_a, i_b = -0.013, 0.71, 0.29
    force = (
        31.0 * i_a**2 / (1 + 120 * max(x, 0)) ** 2
        - 23.0 * i_b**2 / (1 + 120 * max(-x, 0)) ** 2
        - C * v
        - K * x
    )
    acceleration, slope = spool_acceleration(x, v, i_a, i_b, bench_joint(UNEQUAL))
    assert_allclose(acceleration, force / M, rtol=1e-13)
    assert_allclose(slope, -C / M, rtol=1e-13)


def test_solenoids_on_one_spool_act_left_and_right_alike(bench_joint):
    joint = bench_joint()
    towards_a = advance(0.0, 0.0, 0.8, 0.1, 0.004, 8, joint)
    towards_b = advance(0.0, 0.0, 0.1, 0.8, 0.004, 8, joint)
    assert_allclose(towards_a, -np.array(towards_b), rtol=1e-14)


def test_spool_follows_the_closed_form_of_a_damped_spring_without_air_gap(bench_joint):
    joint = bench_joint({"solenoid.gap_constant": 0.0})
    force = 30.0 * 0.6**2
    rest = force / K
    roots = np.roots([M, C, K])  # overdamped: 60^2 > 4 * 0.05 * 8000
    weights = np.linalg.solve([[1, 1], roots], [-rest, 0])
    time = 0.011
    expected = rest + np.real(weights @ np.exp(roots * time))
    errors = [abs(advance(0.0, 0.0, 0.6, 0.0, time, steps, joint)[0] - expected) for steps in (200, 400)]
    assert errors[1] < 1e-5 * rest
    assert_allclose(np.log2(errors[0] / errors[1]), 2.0, atol=0.1)  # second order


def test_spool_comes_to_rest_where_magnet_and_spring_balance(bench_joint):
    joint = bench_joint()
    x, v = advance(0.0, 0.0, 0.55, 0.0, 1.0, 4000, joint)
    assert_allclose(30.0 * 0.55**2 / (1 + 120 * x) ** 2, K * x, rtol=1e-9)
    assert abs(v) < 1e-12


def test_spool_step_is_stable_at_any_stiffness_of_its_damping(bench_joint):
    joint = bench_joint({"solenoid.damping": 6e5, "solenoid.gap_constant": 0.0})
    x, v = advance(0.0, 0.0, 0.55, 0.0, 0.5, 1000, joint)  # damping over mass times step: 6000
    assert 0.0 < x < 30.0 * 0.55**2 / K
    assert_allclose(v, (30.0 * 0.55**2 - K * x) / 6e5, rtol=1e-3)


def test_servo_valve_is_a_second_order_lag_with_a_limited_stroke(slide_joint):
    joint = slide_joint()
    x, v = 0.13e-3, 0.021
    acceleration, slope = spool_acceleration(x, v, 0.0, 3.7, joint)
    target = -0.37e-3
    assert_allclose(acceleration, 300.0**2 * (target - x) - 2 * 0.8 * 300.0 * v, rtol=1e-13)
    assert_allclose(slope, -2 * 0.8 * 300.0, rtol=1e-13)
    assert_allclose(advance(0.0, 0.0, 14.0, 0.0, 0.5, 1000, joint)[0], 1e-3, rtol=1e-9)


def test_a_spool_comes_to_rest_where_magnet_spring_and_the_oil_balance(bench_joint):
    """Towards B; the oil closes it, in proportion to its opening."""
    joint = bench_joint({"solenoid.gap_constant": 0.0})
    closing = 2.3
    x, v = advance(0.0, 0.0, 0.0, 0.28, 1.0, 4000, joint, 1.1, closing)
    opening = (-x - 0.06e-3) / (0.35e-3 - 0.06e-3)
    assert 0.0 < opening < 1.0
    assert_allclose(30.0 * 0.28**2, -K * x + closing * opening, rtol=1e-9)
    assert abs(v) < 1e-12
