"""Equation (4.7)'s orifice, smooth through zero, and the oil's stiffness."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.fluid import orifice_conductance, stiffness

AREA, COEFFICIENT = 0.37e-6, 0.63


def _flow(drop, joint):
    return drop * orifice_conductance(AREA, drop, COEFFICIENT, joint)


def test_flow_at_an_odd_point_is_the_written_law(bench_joint):
    joint = bench_joint()
    drop = -0.31e6  # against the direction that is counted positive
    expected = COEFFICIENT * AREA * (2 / 870) ** 0.5 * drop / (drop**2 + 0.2e6**2) ** 0.25
    assert_allclose(_flow(drop, joint), expected, rtol=1e-13)


@pytest.mark.parametrize("drop", [4e6, -4e6, 9.7e6])
def test_flow_tends_to_the_square_root_law_far_above_the_laminar_transition(bench_joint, drop):
    joint = bench_joint()
    root_law = COEFFICIENT * AREA * np.sign(drop) * (2 * abs(drop) / 870) ** 0.5
    leading_error = (0.2e6 / drop) ** 2 / 4  # of (1 + r^2)^(-1/4)
    assert_allclose(_flow(drop, joint), root_law, rtol=1.01 * leading_error)
    assert _flow(drop, joint) != root_law


def test_flow_is_linear_far_below_the_laminar_transition(bench_joint):
    joint = bench_joint()
    slope = COEFFICIENT * AREA * (2 / 870) ** 0.5 / 0.2e6**0.5
    for drop in (13.0, -1700.0):
        assert_allclose(_flow(drop, joint), slope * drop, rtol=(drop / 0.2e6) ** 2 / 3)


def test_flow_is_odd_smooth_and_rising_through_zero(bench_joint):
    joint = bench_joint()
    drops = np.linspace(-1e6, 1e6, 2001)
    flows = np.array([_flow(drop, joint) for drop in drops])
    assert_allclose(flows, -flows[::-1], rtol=1e-12, atol=1e-25)
    assert np.all(np.diff(flows) > 0)
    slopes = np.diff(flows) / np.diff(drops)
    assert np.max(np.abs(np.diff(slopes))) < 0.01 * slopes.max()  # no kink: 1 kPa apart, slope changes little


def test_bulk_modulus_without_air_is_the_oil_s_at_any_pressure(bench_joint):
    joint = bench_joint()
    for pressure in (0.0, 3e3, 7.3e6):
        assert_allclose(stiffness(1.0, pressure, joint), 1.0e9, rtol=1e-14)


def test_bulk_modulus_with_air_is_two_springs_in_series(bench_joint):
    joint = bench_joint({"effects.fluid.entrained_air.air_fraction": 0.07})
    pressure = 0.9e6
    assert_allclose(1 / stiffness(1.0, pressure, joint), 1 / 1e9 + 0.07 * 1e5 / pressure**2, rtol=1e-13)
    # below the atmosphere the air's stiffness stays that at the atmosphere
    assert_allclose(1 / stiffness(1.0, 2e4, joint), 1 / 1e9 + 0.07 / 1e5, rtol=1e-13)
