"""Dry friction that bristles hold: closed forms and rest; both executions stand in `test_component_executions`."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from hydrolek_drake.physics.friction import bending, bent_after, bristle_rate
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

SMOOTH, DEFLECTION = 1e-4, 2e-5  # m/s, m
COULOMB = "effects.cylinder.coulomb_friction.coulomb_N"
BRISTLES = "cylinder.bristle_deflection"
LEVEL = 1500.0  # N


@pytest.mark.parametrize("velocity", [0.05, 2e-4, 3e-5, -1e-3, 0.0])
@pytest.mark.parametrize(("bent", "fading"), [(-0.9, 1.0), (0.0, 0.4), (0.6, 0.7)])
def test_a_way_at_a_steady_speed_bends_bristles_as_their_equation_says(velocity, bent, fading):
    h = 0.02
    told = solve_ivp(
        lambda t, s: [bristle_rate(s[0], velocity, fading, SMOOTH, DEFLECTION)],
        (0.0, h),
        [bent],
        rtol=1e-10,
        atol=1e-13,
        method="LSODA",
    )
    found = bent_after(bent, velocity * h, h, fading, SMOOTH, DEFLECTION)
    assert_allclose(found, told.y[0, -1], atol=1e-8)


def test_what_slides_on_feels_the_smoothed_sign_of_its_speed():
    for velocity in (0.05, 1e-4, -2e-5):
        share = bent_after(0.3, velocity * 10.0, 10.0, 0.6, SMOOTH, DEFLECTION)
        assert_allclose(share, 0.6 * velocity / np.hypot(velocity, SMOOTH), rtol=1e-12)


def test_without_creep_it_is_dahls_friction_which_depends_on_the_way_alone():
    way, creep = 1.3 * DEFLECTION, 1e-12
    for h in (1e-3, 10.0):
        assert_allclose(bent_after(0.0, way, h, 1.0, creep, DEFLECTION), 1.0 - np.exp(-1.3), rtol=1e-9)
    there = bent_after(0.0, way, 1.0, 1.0, creep, DEFLECTION)
    back = bent_after(there, -way, 1.0, 1.0, creep, DEFLECTION)
    assert_allclose(back, -1.0 + (2.0 - np.exp(-1.3)) * np.exp(-1.3), rtol=1e-9)


def test_the_stiffness_is_that_of_a_short_way():
    for bent, velocity in ((0.2, 1e-9), (0.5, 1e-3), (-0.4, 1e-3)):
        h, fading = 1e-7, 0.8
        further = bent_after(bent, velocity * h, h, fading, 1e-12, DEFLECTION)
        rate, rise = bending(bent, velocity, h, fading, 1e-12, DEFLECTION)
        assert_allclose((further - bent) / (velocity * h), rise, rtol=1e-4)
        assert_allclose(rate, bristle_rate(bent, velocity, fading, 1e-12, DEFLECTION), rtol=1e-4)


@pytest.fixture(scope="module")
def gripped():
    """A joint whose seals grip, with bristles or without."""

    def rig(**values):
        return load_rig("joint_bench").with_values({COULOMB: LEVEL, **values})

    return rig


def _pushed(rig, step):
    """To and fro, and then no command: rest with chambers out of balance."""
    times = np.arange(0.0, 8.0, 0.02)
    volts = np.select([times < 1.0, times < 2.0], [4.0, -4.0], 0.0)
    return times, roll_out(rig.records(), times, volts, times, longest_step=step).signals


def _force(rig, signals):
    """Of the oil on the piston [N]."""
    p = rig.records()[0]["cylinder"]
    return p["area_a"] * signals.pressure_a - p["area_b"] * signals.pressure_b


HELD = {BRISTLES: DEFLECTION, "cylinder.friction_velocity": 1e-9, "cylinder.bristle_time": 2e-4}


def test_bristles_hold_a_joint_that_smoothed_friction_lets_creep(gripped):
    """What is left of a move stays in the chambers; a friction that is smoothed gives way until they balance."""
    unbalanced = []
    for rig in (gripped(**HELD), gripped()):
        times, signals = _pushed(rig, 5e-4)
        force = _force(rig, signals)
        unbalanced.append(abs(force[-1] - force[0]))  # where it begins nothing rubs
        rests = times > 4.0
    held, creeping = unbalanced
    assert creeping < 0.02 * LEVEL < 0.2 * LEVEL < held < LEVEL
    _, signals = _pushed(gripped(**HELD), 5e-4)
    lever = 0.2  # m, more than the rod has
    assert lever * np.ptp(signals.position[rests]) < 0.1 * DEFLECTION


def test_steps_four_times_as_long_lead_to_the_same_rest(gripped):
    rig = gripped(**HELD)
    _, fine = _pushed(rig, 1.25e-4)
    for step in (5e-4, 2e-3):
        _, coarse = _pushed(rig, step)
        assert_allclose(coarse.position[-1], fine.position[-1], atol=np.radians(0.02))
        assert_allclose(_force(rig, coarse)[-1], _force(rig, fine)[-1], atol=0.02 * LEVEL)
