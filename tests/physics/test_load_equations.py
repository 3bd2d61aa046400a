"""Gravity, inertia, payload, damping and end stops of the load; and the base."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics import base, load
from hydrolek_drake.physics.angle import angle

PAYLOAD = {"effects.load.payload.mass_kg": 7.0, "effects.load.payload.time_s": 3.0}
LOWER, UPPER = np.radians(-10.3), np.radians(65.6)


def test_gravity_moment_is_that_of_a_rigid_body_about_a_fixed_axis(bench_joint):
    q = 0.61
    joint = bench_joint({"load.gravity_sin": 31.0})
    assert_allclose(load.gravity_load(q, 0.0, joint), 265 * np.cos(q) + 31 * np.sin(q), rtol=1e-14)


def test_payload_adds_its_weight_and_inertia_from_its_time_on(bench_joint):
    q = 0.61
    joint = bench_joint(PAYLOAD)
    assert_allclose(load.gravity_load(q, 2.9, joint), 265 * np.cos(q), rtol=1e-14)
    assert_allclose(load.gravity_load(q, 3.0, joint), (265 + 7 * 9.81) * np.cos(q), rtol=1e-14)
    assert load.moving_inertia(2.9, joint) == 25.0
    assert_allclose(load.moving_inertia(3.1, joint), 25.0 + 7.0 * 1.0, rtol=1e-14)


def test_a_slide_is_loaded_by_a_constant_force(slide_joint):
    joint = slide_joint({"load.gravity_cos": 37.0})
    assert load.gravity_load(0.13, 0.0, joint) == 37.0


@pytest.mark.parametrize(
    ("q", "w"), [(UPPER + 0.01, 0.3), (UPPER + 0.01, -0.3), (LOWER - 0.02, -0.3), (LOWER - 0.02, 0.3)]
)
def test_stops_push_back_with_stiffness_and_damping(bench_joint, q, w):
    overtravel = q - (UPPER if q > UPPER else LOWER)
    expected = -4e5 * overtravel - 2e3 * w
    assert_allclose(load.stop_load(q, w, bench_joint()), expected, rtol=1e-12)
    assert load.stop_slope(q, bench_joint()) == 2e3


def test_stops_leave_the_travel_between_them_alone(bench_joint):
    for q in (LOWER + 1e-9, 0.3, UPPER - 1e-9):
        assert load.stop_load(q, 0.7, bench_joint()) == 0.0
        assert load.stop_slope(q, bench_joint()) == 0.0


@pytest.mark.parametrize("q", [0.61, UPPER + 0.01])
def test_resisting_load_is_the_sum_and_its_slope_that_of_the_dampers_and_the_friction_s_secant(
    bench_joint, q
):
    joint = bench_joint(
        {"effects.load.coulomb_friction.force_N": 11.0, "load.friction_velocity": 0.05, **PAYLOAD}
    )
    w = 0.037
    total, slope = load.resisting_load(angle(q), w, 4.0, joint)
    friction = 11 * np.tanh(w / 0.05)
    by_hand = (265 + 7 * 9.81) * np.cos(q) + 60 * w + friction - load.stop_load(q, w, joint)
    assert_allclose(total, by_hand, rtol=1e-12)
    assert_allclose(slope, 60 + friction / w + (2e3 if q > UPPER else 0.0), rtol=1e-12)


def test_rod_mass_adds_its_inertia_at_the_lever_in_mid_travel(bench_joint):
    assert load.reflected_rod_inertia(bench_joint()) == 0.0
    middle = 0.5 * (LOWER + UPPER)
    length = np.sqrt(0.12**2 + 0.35**2 - 2 * 0.12 * 0.35 * np.cos(middle + np.pi / 3))
    lever = 0.12 * 0.35 * np.sin(middle + np.pi / 3) / length
    assert_allclose(
        load.reflected_rod_inertia(bench_joint({"cylinder.rod_mass": 1.7})), 1.7 * lever**2, rtol=1e-12
    )


def test_a_rocking_base_is_the_bench_s_equation(bench_joint):
    joint = bench_joint(
        {
            "effects.base.compliance.stiffness_Nm_per_rad": 3e4,
            "effects.base.compliance.inertia_kg_m2": 80.0,
        }
    )
    tilt, rate, moment = 0.004, -0.013, 210.0
    acceleration, slope = base.base_acceleration(tilt, rate, moment, joint)
    damping = 0.1 * np.sqrt(3e4 * 80.0)
    assert_allclose(acceleration, (-moment - 3e4 * tilt - damping * rate) / 80.0, rtol=1e-12)
    assert_allclose(slope, -damping / 80.0, rtol=1e-12)


def test_one_mass_and_its_place_give_inertia_and_gravity_together(link_joint, bench_joint):
    """A uniform link of 0.5 m and 20 kg: m l^2/3 and m g l/2."""
    mass, length = 20.0, 0.5
    joint = link_joint(
        {
            "load.mass": mass,
            "load.centre_along": length / 2,
            "load.gyration_radius": length / np.sqrt(12.0),
            "load.gravity": 9.81,
        }
    )
    assert_allclose(load.moving_inertia(0.0, joint), mass * length**2 / 3, rtol=1e-12)
    for q in (-0.4, 0.0, 1.1):
        assert_allclose(load.gravity_load(q, 0.0, joint), mass * 9.81 * length / 2 * np.cos(q), rtol=1e-12)


def test_a_mass_across_the_link_pulls_it_down_behind_the_axis(link_joint):
    joint = link_joint(
        {"load.mass": 7.0, "load.centre_along": 0.3, "load.centre_across": 0.2, "load.gravity": 9.81}
    )
    q = 0.7
    x = 0.3 * np.cos(q) - 0.2 * np.sin(q)  # of the centre, level
    assert_allclose(load.gravity_load(q, 0.0, joint), 7.0 * 9.81 * x, rtol=1e-12)
