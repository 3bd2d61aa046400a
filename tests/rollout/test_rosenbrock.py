"""A step of the Rosenbrock-W method: its matrix is the stiff part of the Jacobian, and oil springs allow long steps."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rates import Slopes, State
from hydrolek_drake.rollout.rosenbrock import implicit, pushed, through_oil

SLOPES = Slopes(
    p_a=-90.0, p_b=-40.0, w=-15.0, tilt_rate=-6.0, lead_w=-30.0, supply=-50.0,
    falls_a=4e6, rises_b=3e6, turned_by=2e-3, tilted_by=8e-4, contact=3.0, sprung=2e4, lever=0.1,
)  # fmt: skip
RATES = State(
    p_a=2e7,
    p_b=-1e7,
    q=0.3,
    w=5.0,
    supply=0.0,
    tilt=0.01,
    tilt_rate=-2.0,
    lead_q=0.4,
    lead_w=7.0,
    relief=0.0,
    bent=0.0,
)
STEP = 2e-3


def _jacobian(joint, turned: str) -> np.ndarray:
    """J of the docstring, entry by entry."""
    of = State._fields.index
    j = np.zeros((len(State._fields), len(State._fields)))
    for name in ("p_a", "p_b", "w", "tilt_rate", "lead_w"):
        j[of(name), of(name)] = getattr(SLOPES, name)
    for position, rate in (("q", "w"), ("tilt", "tilt_rate"), ("lead_q", "lead_w")):
        j[of(position), of(rate)] = 1.0
    for side, by in ((turned, 1.0), ("tilt_rate", -1.0)):
        j[of("p_a"), of(side)] -= by * SLOPES.falls_a
        j[of("p_b"), of(side)] += by * SLOPES.rises_b
    j[of(turned), of("q" if turned == "w" else "lead_q")] -= SLOPES.sprung
    areas = {"p_a": joint["cylinder"]["area_a"], "p_b": -joint["cylinder"]["area_b"]}
    for pressure, area in areas.items():
        j[of(turned), of(pressure)] += SLOPES.turned_by * area
        j[of("tilt_rate"), of(pressure)] -= SLOPES.tilted_by * area
    return j


@pytest.mark.parametrize(("gap", "turned"), [(0.0, "w"), (0.02, "lead_w")])
def test_a_stage_solves_the_linear_system_of_its_jacobian(bench, gap, turned):
    joint = bench.with_values({"effects.linkage.backlash.gap_rad": gap}).records()[0]
    found = np.array(implicit(RATES, SLOPES, STEP, joint))
    matrix = np.eye(len(State._fields)) - GAMMA * STEP * _jacobian(joint, turned)
    assert_allclose(found, np.linalg.solve(matrix, np.array(RATES)), rtol=1e-12)


def test_a_joint_among_others_feels_the_oil_as_one_alone_does(bench):
    """`through_oil` and `pushed` leave the equation of one joint, solved for its acceleration, as `implicit` does."""
    joint, inertia = bench.records()[0], 25.0
    slopes = SLOPES._replace(sprung=0.0)  # which has no part in the arms' equation
    drag, share = through_oil(slopes, STEP, inertia, joint)
    moment = inertia * RATES.w + share * pushed(RATES, slopes, STEP, joint)
    mass = inertia + GAMMA * STEP * (drag - slopes.w * inertia)
    assert_allclose(moment / mass, implicit(RATES, slopes, STEP, joint).w, rtol=1e-12)


def _driven(rig: str, step: float) -> np.ndarray:
    """Position of a joint that is driven about for 5 s [rad]."""
    record = load_rig(rig).records()[:1]
    times = np.arange(0.0, 5.0, 0.01)
    volts = np.repeat(np.random.default_rng(2).uniform(-6.0, 6.0, 20), 25)
    done = roll_out(record, times, volts, times, longest_step=step)
    assert done.diverged is None
    return done.signals.position


@pytest.mark.parametrize("rig", ["hydrolek_left_j5", "hydrolek_right_j4", "hydrolek_left_j2"])
def test_small_chambers_do_not_shorten_the_step(rig):
    """Their oil springs ring at 30 to 200 Hz; with the diagonal alone steps of 4 ms made left_j5 run away."""
    fine = _driven(rig, 5e-5)
    coarse, middle = (np.abs(_driven(rig, step) - fine).max() for step in (4e-3, 1e-3))
    assert np.degrees(coarse) < 1.0
    assert np.degrees(middle) < 0.1
    assert middle < 0.25 * coarse
