"""Four-bar mechanisms, tables of levers and ball screws beside closed forms."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.optimize import fsolve

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.linkage import stroke_and_lever
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

ANGLES = np.radians(np.linspace(-10.0, 65.0, 16))


def _strokes(rig):
    joint = rig.records()[0]
    return np.array([stroke_and_lever(q, joint) for q in ANGLES])


def test_a_four_bar_mechanism_closes_and_its_lever_is_the_slope_of_its_stroke(with_component):
    rig = with_component("four_bar")
    joint, step = rig.records()[0], 1e-6
    for q in ANGLES:
        turned = q + math.radians(70)
        pin = 0.25 * np.array([math.cos(turned), math.sin(turned)])

        def apart(crank, pin=pin):
            return math.dist(pin, (0.30 + 0.27 * math.cos(crank[0]), 0.27 * math.sin(crank[0]))) - 0.28

        stroke, lever = stroke_and_lever(q, joint)
        lengths = []
        for guess in np.radians([-60, 0, 60, 120, 180, 240]):
            (crank,), _, done, _ = fsolve(apart, [guess], full_output=True)
            rod = 0.16 * np.array([math.cos(crank + math.radians(20)), math.sin(crank + math.radians(20))])
            if done == 1:
                lengths.append(math.dist(rod, (-0.10, -0.45)) - 0.38)
        assert min(abs(np.array(lengths) - stroke)) < 1e-9  # one of both ways to put it together
        ahead, behind = (stroke_and_lever(q + d, joint)[0] for d in (step, -step))
        assert_allclose(lever, (ahead - behind) / (2 * step), rtol=1e-6)


def test_a_parallelogram_turns_its_crank_as_the_link_and_is_a_triangle(with_component):
    """Ground and coupler alike, link and crank alike: the crank's angle is the link's, so a triangle at G remains."""
    rig = with_component("four_bar").with_values(
        {
            "linkage.ground": 0.30, "linkage.coupler": 0.30, "linkage.link_arm": 0.2, "linkage.crank_arm": 0.2,
            "linkage.assembly": -1.0, "linkage.cylinder_angle": 0.0, "linkage.link_angle": math.radians(60),
            "linkage.cylinder_arm": 0.35, "linkage.mount_x": 0.12, "linkage.mount_y": 0.0,
            "linkage.zero_stroke_length": 0.2873493667,
        }
    )  # fmt: skip
    assert_allclose(_strokes(rig), _strokes(load_rig("joint_bench")), rtol=1e-9, atol=1e-12)


def test_a_mechanism_that_cannot_be_put_together_is_refused(with_component):
    with pytest.raises(InputError, match=r"impossible mechanism, at 65\.6 deg"):
        with_component("four_bar").with_values({"linkage.coupler": 0.02})


def test_a_table_of_levers_gives_them_and_the_stroke_is_their_integral(with_component):
    rig = with_component("lever_table")
    knots = np.radians(np.linspace(-10.3, 65.6, 9))
    levers = np.array([0.111, 0.115, 0.118, 0.120, 0.120, 0.119, 0.116, 0.112, 0.107])
    joint = rig.records()[0]
    fine = np.linspace(math.radians(-20), math.radians(80), 4001)
    found = np.array([stroke_and_lever(q, joint) for q in fine])
    assert_allclose(found[:, 1], np.interp(fine, knots, levers), rtol=1e-12)
    area = np.concatenate([[0], np.cumsum(np.diff(fine) * 0.5 * (found[1:, 1] + found[:-1, 1]))])
    assert_allclose(found[:, 0] - found[0, 0], area, atol=1e-8)
    assert_allclose(stroke_and_lever(knots[0], joint)[0], 0.0, atol=1e-15)


def test_a_triangle_by_its_table_moves_as_the_triangle(with_component):
    bench = load_rig("joint_bench").records()[0]
    knots = np.radians(np.linspace(-10.3, 65.6, 9))
    levers = {f"linkage.lever_{k}": stroke_and_lever(q, bench)[1] for k, q in enumerate(knots)}
    rig = with_component("lever_table").with_values(levers)
    exact = np.array([stroke_and_lever(q, bench) for q in ANGLES])
    # straight lines under a curve are off by h^2/8 times its second derivative
    fine = np.linspace(knots[0], knots[-1], 801)
    curve = np.array([stroke_and_lever(q, bench)[1] for q in fine])
    bent = np.abs(np.gradient(np.gradient(curve, fine), fine)[2:-2]).max()
    assert np.abs(_strokes(rig)[:, 1] - exact[:, 1]).max() <= (knots[1] - knots[0]) ** 2 / 8 * bent * 1.01


@pytest.mark.parametrize(
    "wrong", [{"linkage.last_position": -1.0}, {"linkage.lever_4": -0.12}], ids=["angles", "sign"]
)
def test_a_table_that_makes_no_sense_is_refused(with_component, wrong):
    with pytest.raises(InputError, match="linkage"):
        with_component("lever_table").with_values(wrong)


@pytest.mark.parametrize(("volts", "amps"), [(2.0, 1.0), (10.0, 4.0)])
def test_a_ball_screw_accelerates_its_nut_and_its_rotor(with_component, volts, amps):
    rig = with_component("ball_screw").with_values({"load.damping": 0.0})
    times = np.arange(0.0, 0.2, 0.01)
    signals = roll_out(rig.records(), times, np.full(times.size, volts), times, longest_step=1e-3).signals
    turn = 2 * math.pi / 5e-3
    force, mass = turn * 0.9 * 0.08 * amps, 95.1089 + 2e-5 * turn**2
    assert_allclose(signals.position, 0.5 * force / mass * times**2, rtol=1e-6, atol=1e-12)


def test_a_motor_moves_its_axis_directly(with_component):
    with pytest.raises(InputError, match="moves its axis directly"):
        with_component("motor_on_a_mechanism")
