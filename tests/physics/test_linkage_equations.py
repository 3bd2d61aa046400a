"""Stroke, lever and play between the actuator and the joint."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad

from hydrolek_drake.physics.linkage import mean_play_torque, play_torque, stroke_and_lever

REVERSED = {"linkage.direction": -1.0, "linkage.angle_offset": np.radians(100.0)}


@pytest.mark.parametrize("values", [{}, REVERSED], ids=["extension raises", "extension lowers"])
@pytest.mark.parametrize("q", [-0.13, 0.41, 1.07])
def test_lever_is_the_derivative_of_the_stroke(bench_joint, values, q):
    if values:
        values = {**values, "linkage.zero_stroke_length": 0.24}
    joint = bench_joint(values)
    step = 1e-6
    slope = (stroke_and_lever(q + step, joint)[0] - stroke_and_lever(q - step, joint)[0]) / (2 * step)
    lever = stroke_and_lever(q, joint)[1]
    assert_allclose(lever, slope, rtol=1e-8)
    assert np.sign(lever) == (values or {"linkage.direction": 1.0})["linkage.direction"]


def test_stroke_is_the_law_of_cosines_less_the_length_with_the_rod_in(bench_joint):
    q = 0.37
    length = np.sqrt(0.12**2 + 0.35**2 - 2 * 0.12 * 0.35 * np.cos(q + np.pi / 3))
    stroke, lever = stroke_and_lever(q, bench_joint())
    assert_allclose(stroke, length - 0.2873493667, rtol=1e-12)
    assert_allclose(lever, 0.12 * 0.35 * np.sin(q + np.pi / 3) / length, rtol=1e-12)
    assert_allclose(stroke_and_lever(np.radians(-10.3), bench_joint())[0], 0.0, atol=1e-9)


def test_force_times_stroke_is_moment_times_angle(bench_joint):
    """Virtual work over the whole travel: the work of a constant rod force is force times stroke."""
    joint = bench_joint()
    angles = np.linspace(np.radians(-10.3), np.radians(65.6), 2001)
    strokes, levers = np.array([stroke_and_lever(q, joint) for q in angles]).T
    work = 1234.0 * np.trapezoid(levers, angles)
    assert_allclose(work, 1234.0 * (strokes[-1] - strokes[0]), rtol=1e-7)  # trapezoid's own error


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_direct_drive_has_lever_plus_or_minus_one(slide_joint, direction):
    joint = slide_joint({"linkage.direction": direction, "linkage.zero_stroke_position": 0.03})
    assert_allclose(stroke_and_lever(0.11, joint), (direction * 0.08, direction), rtol=1e-14)


def test_play_carries_nothing_inside_its_gap_and_is_spring_and_damper_where_closed(bench_joint):
    gap = 0.015
    joint = bench_joint({"effects.linkage.backlash.gap_rad": gap})
    assert play_torque(0.007, 3.0, joint) == 0.0
    assert play_torque(-0.007, -3.0, joint) == 0.0
    assert_allclose(play_torque(0.009, 0.3, joint), 2e5 * (0.009 - gap / 2) + 400 * 0.3, rtol=1e-12)
    assert_allclose(play_torque(-0.009, -0.3, joint), -2e5 * (0.009 - gap / 2) - 400 * 0.3, rtol=1e-12)


@pytest.mark.parametrize(
    ("lead", "velocity"),
    [(0.0, 12.0), (0.0088, -9.0), (-0.0079, 6.0), (0.02, -30.0), (0.0, 0.5), (0.009, 0.0)],
)
def test_the_mean_of_a_play_over_a_step_counts_the_share_in_contact(bench_joint, lead, velocity):
    """Against a numeric mean on the straight way; what presses the sides together yields to nothing here."""
    gap, step = 0.015, 1e-3
    joint = bench_joint({"effects.linkage.backlash.gap_rad": gap})
    meet = [(side * 0.5 * gap - lead) / velocity for side in (-1.0, 1.0)] if velocity else []
    whole, _ = quad(
        lambda t: play_torque(lead + velocity * t, velocity, joint),
        0.0,
        step,
        points=[t for t in meet if 0.0 < t < step] or None,
    )
    assert_allclose(
        mean_play_torque(lead, velocity, 0.0, 0.0, step, joint), whole / step, rtol=1e-9, atol=1e-9
    )
    assert mean_play_torque(lead, velocity, 0.0, 0.0, 0.0, joint) == play_torque(lead, velocity, joint)


def test_the_mean_of_a_play_has_no_leap_where_the_sides_meet_a_step_sooner(bench_joint):
    joint, step = bench_joint({"effects.linkage.backlash.gap_rad": 0.015}), 1e-3
    leads = (
        0.0075 - 0.3 * step + np.linspace(-1e-6, 1e-6, 201)
    )  # the end of the step passes the edge of the gap
    means = [mean_play_torque(lead, 0.3, 0.0, 0.0, step, joint) for lead in leads]
    assert np.abs(np.diff(means)).max() < 0.02 * play_torque(0.0075 + 1e-9, 0.3, joint)


@pytest.mark.parametrize("hardness", [1.0, 1e4])
def test_in_contact_a_play_takes_the_implicit_midpoint_rule(bench_joint, hardness):
    """The mean is the contact's moment in the middle of a way that this mean itself decelerates."""
    gap, step, yields, parting = 0.015, 1e-3, 0.6, 40.0
    joint = bench_joint({"effects.linkage.backlash.gap_rad": gap, "linkage.play_stiffness": hardness * 2e5})
    stiffness, damping = joint["linkage"]["play_stiffness"], joint["linkage"]["play_damping"]
    lead, velocity = 0.5 * gap + 1.2 * parting / (yields * stiffness), 0.0
    mean = mean_play_torque(lead, velocity, parting, yields, step, joint)
    pace = velocity + 0.5 * step * (parting - yields * mean)
    assert lead + step * pace > 0.5 * gap  # still pressed together
    middle = lead - 0.5 * gap + 0.5 * step * pace
    # hard sides are pressed together by nanometres beside a play of millimetres, of which six digits are left
    assert mean == pytest.approx(stiffness * middle + damping * pace, rel=1e-6)


@pytest.mark.parametrize("turns", [0.1, 1.0, 10.0, 100.0])
def test_a_play_gains_no_energy_however_hard_it_closes(bench_joint, turns):
    """Two bodies that meet at 0.3 rad/s, a contact that swings by so many radians in a step, no damping."""
    gap, step, yields = 0.015, 1e-3, 0.6
    stiffness = (turns / step) ** 2 / yields
    joint = bench_joint({
        "effects.linkage.backlash.gap_rad": gap, "linkage.play_stiffness": stiffness, "linkage.play_damping": 0.0,
    })  # fmt: skip
    lead, velocity, fastest = 0.0, 0.3, 0.0
    for _ in range(2000):
        ahead = velocity - step * yields * mean_play_torque(lead, velocity, 0.0, yields, step, joint)
        lead, velocity = lead + 0.5 * step * (velocity + ahead), ahead
        fastest = max(fastest, abs(velocity))
    assert fastest <= 0.3 * 1.01
