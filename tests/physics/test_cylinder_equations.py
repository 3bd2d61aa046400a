"""Equation (4.9) and continuity."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics import cylinder, end_stops, rod_friction
from hydrolek_drake.rigs import load_rig

A_A, A_B, V_0, B = 800e-6, 600e-6, 40e-6, 1e9


def test_chamber_volumes_grow_and_shrink_with_the_stroke_and_keep_their_dead_volume(bench_joint):
    joint = bench_joint()
    assert_allclose(cylinder.chamber_volumes(0.07, joint), (V_0 + A_A * 0.07, V_0 + A_B * 0.33), rtol=1e-14)
    assert_allclose(cylinder.chamber_volumes(-0.01, joint)[0], V_0, rtol=1e-14)
    assert_allclose(cylinder.chamber_volumes(0.43, joint)[1], V_0, rtol=1e-14)


def test_pressure_rates_are_continuity(bench_joint):
    joint = bench_joint()
    s, v, q_a, q_b = 0.07, -0.031, 1.3e-5, -0.9e-5
    rate_a, rate_b, stiff_a, stiff_b = cylinder.pressure_rates(7e6, 3e6, q_a, q_b, s, v, joint)
    assert_allclose(rate_a, B / (V_0 + A_A * s) * (q_a - A_A * v), rtol=1e-13)
    assert_allclose(rate_b, B / (V_0 + A_B * (0.40 - s)) * (q_b + A_B * v), rtol=1e-13)
    assert_allclose((stiff_a, stiff_b), (B / (V_0 + A_A * s), B / (V_0 + A_B * (0.40 - s))), rtol=1e-13)


def test_an_oil_column_gives_way_by_its_least_compliance(bench_joint):
    """V / (B A^2) >= c: at zero stroke side A is softer than its dead volume, in mid-stroke both are as they are."""
    least = 1.5e-7
    joint = bench_joint({"cylinder.column_compliance": least})
    for stroke in (0.0, 0.2, 0.4):
        volumes = cylinder.chamber_volumes(stroke, joint)
        _, _, *stiffnesses = cylinder.pressure_rates(7e6, 3e6, 0.0, 0.0, stroke, 0.0, joint)
        for area, volume, stiffness in zip((A_A, A_B), volumes, stiffnesses, strict=True):
            assert_allclose(1.0 / (stiffness * area**2), max(volume / (B * area**2), least), rtol=1e-12)


def test_pressures_do_not_fall_below_zero_but_rise_from_there(bench_joint):
    joint = bench_joint()
    assert cylinder.pressure_rates(0.0, 0.0, -1e-5, -1e-5, 0.07, 0.0, joint)[:2] == (0.0, 0.0)
    rising = cylinder.pressure_rates(0.0, 0.0, 1e-5, 1e-5, 0.07, 0.0, joint)
    assert rising[0] > 0.0 and rising[1] > 0.0


def test_rod_force_of_4_9(bench_joint):
    joint = bench_joint()
    assert_allclose(cylinder.pressure_force(7.3e6, 3.1e6, joint), A_A * 7.3e6 - A_B * 3.1e6, rtol=1e-14)
    force, slope, _ = rod_friction.friction_force(0.07, -0.031, 0.0, 0.0, 0.0, joint)
    assert_allclose((force, slope), (3000 * -0.031, 3000), rtol=1e-14)


@pytest.mark.parametrize(
    ("stroke", "velocity", "expected"),
    [
        (0.41, 0.03, 0.01 * 5e6 * 0.03),
        (0.41, -0.03, 0.0),  # leaving the stop
        (-0.02, -0.03, 0.02 * 5e6 * -0.03),
        (-0.02, 0.03, 0.0),
        (0.2, 0.3, 0.0),
    ],
)
def test_hard_stop_of_4_9_opposes_only_what_goes_further_in(bench_joint, stroke, velocity, expected):
    # (4.9) subtracts F_C and prints x K_p v for x < 0, v < 0: positive, so it would pull the rod further in;
    # the code takes -x K_p v (docs/reference/thesis_errata.md), which opposes the motion at both ends
    joint = bench_joint({"cylinder.stop_penetration": 5e6})
    assert_allclose(end_stops.hard_stop_force(stroke, velocity, joint), expected, rtol=1e-12, atol=0)
    assert end_stops.hard_stop_force(stroke, velocity, joint) * velocity >= 0.0


def test_a_vane_is_the_cylinder_s_equations_with_displacements(bench):
    records = bench.records()
    records["cylinder"]["variant"] = cylinder.VANE
    for name, value in {"area_a": 3e-5, "area_b": 2.7e-5, "stroke": 3.1}.items():
        records["cylinder"][name] = value
    joint = records[0]
    assert_allclose(cylinder.chamber_volumes(1.1, joint), (V_0 + 3e-5 * 1.1, V_0 + 2.7e-5 * 2.0), rtol=1e-13)
    assert_allclose(cylinder.pressure_force(7e6, 3e6, joint), 3e-5 * 7e6 - 2.7e-5 * 3e6, rtol=1e-13)


def test_a_hydraulic_motor_has_chambers_of_constant_volume_and_no_stop(bench):
    records = bench.records()
    records["cylinder"]["variant"] = cylinder.HYDRAULIC_MOTOR
    for stroke in (-7.0, 0.0, 31.0):
        assert_allclose(cylinder.chamber_volumes(stroke, records[0]), (V_0, V_0), rtol=1e-14)
        assert end_stops.hard_stop_force(stroke, np.sign(stroke), records[0]) == 0.0


def test_electric_motor_is_a_force_constant():
    joint = load_rig("emps").records()[0]
    constant = joint["cylinder"]["force_constant"]
    assert constant > 0
    assert_allclose(cylinder.motor_force(-1.7, joint), -1.7 * constant, rtol=1e-14)


@pytest.mark.parametrize(
    ("stroke", "velocity", "force"),
    [
        (0.1, 0.3, 0.0),
        (-0.002, -0.1, -0.002 * 5e6 - 0.1 * 3e3),
        (-0.002, 0.1, -0.002 * 5e6 + 0.1 * 3e3),
        (-0.002, 9.0, 0.0),  # it leaves faster than the stop follows, and is not pulled
        (0.203, 0.1, 0.003 * 5e6 + 0.1 * 3e3),
        (0.203, -9.0, 0.0),
    ],
)
def test_a_piston_s_stops_push_back_beyond_its_stroke_and_never_pull(link_joint, stroke, velocity, force):
    joint = link_joint(
        {
            "cylinder.stroke": 0.2,
            "cylinder.stop_stiffness": 5e6,
            "cylinder.stop_damping": 3e3,
            "cylinder.stop_exponent": 1.0,
            "cylinder.stop_dissipation": 0.0,
            "cylinder.viscous_friction": 0.0,
        }
    )
    found, slope, _ = rod_friction.friction_force(stroke, velocity, 0.0, 0.0, 0.0, joint)
    assert_allclose(found, force, rtol=1e-12, atol=1e-9)
    assert slope == 0.0
    if force:
        assert_allclose(end_stops.slopes(stroke, velocity, 0.0, joint), (3e3, 5e6), rtol=1e-9)


@pytest.mark.parametrize("depth", [0.2e-3, 1e-3, 3e-3])
@pytest.mark.parametrize("speed", [0.05, 0.0, -0.05])
def test_a_stop_that_hardens_is_hunt_and_crossley_s(link_joint, depth, speed):
    """F = K d^n (1 + 3/2 alpha v) with K = k/(1 mm)^(n - 1) and c = 3/2 alpha."""
    joint = link_joint(
        {
            "cylinder.stroke": 0.2, "cylinder.stop_stiffness": 5e6, "cylinder.stop_damping": 0.0,
            "cylinder.stop_exponent": 1.5, "cylinder.stop_dissipation": 6.0, "cylinder.viscous_friction": 0.0,
        }
    )  # fmt: skip
    expected = 5e6 / 1e-3**0.5 * depth**1.5 * (1.0 + 6.0 * speed)
    found, slope, _ = rod_friction.friction_force(0.2 + depth, speed, 0.0, 0.0, 0.0, joint)
    assert_allclose(found, expected, rtol=1e-12)
    damping, stiffness = end_stops.slopes(0.2 + depth, speed, 0.0, joint)
    assert_allclose(slope + damping, 5e6 / 1e-3**0.5 * depth**1.5 * 6.0, rtol=1e-12)
    if speed >= 0.0:  # outwards the stiffness of one that is still pressed, which is larger
        assert_allclose(stiffness, 1.5 * expected / depth, rtol=1e-9)
    assert_allclose(
        rod_friction.friction_force(-depth, -speed, 0.0, 0.0, 0.0, joint)[0], -expected, rtol=1e-12
    )


def test_what_hits_a_stop_of_hunt_and_crossley_loses_the_more_the_faster_it_comes(link_joint):
    """Slow impacts rebound with 1 - alpha v of their speed (Hunt and Crossley 1975), to first order in alpha v."""
    joint = link_joint(
        {
            "cylinder.stroke": 0.2, "cylinder.stop_stiffness": 5e6, "cylinder.stop_damping": 0.0,
            "cylinder.stop_exponent": 1.5, "cylinder.stop_dissipation": 1.5, "cylinder.viscous_friction": 0.0,
        }
    )  # fmt: skip
    for came in (0.02, 0.05):
        x, v, h, mass = 0.0, came, 1e-6, 50.0
        while x >= 0.0:
            force = rod_friction.friction_force(0.2 + x, v, 0.0, 0.0, 0.0, joint)[0]
            v -= h * force / mass
            x += h * v
        assert_allclose(-v / came, 1.0 - came, atol=2.0 * came**2)
