"""The simulated operator at the thesis's SDP joints: one valve at a time, arrival, time against tolerance, learning."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import joystick_law, thesis_setting
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.teleop.joystick_operator import Goal, JoystickOperator
from hydrolek_drake.teleop.operator_model import make_operator, preparation, reaction_time
from hydrolek_drake.teleop.stick_rates import stick_rates

SETTINGS = [thesis_setting(f"j{number}") for number in range(1, 5)]
RATES = stick_rates(SETTINGS)
START = np.radians([-10.0, 10.0, -10.0, 0.0])
END = np.radians([20.0, 40.0, -30.0, -40.0])
LEVERS = np.array([1.2, 1.1, 0.6, 0.4])  # m


class Joints:
    """Four SDP joints under the joystick's law, a control sample at a time."""

    def __init__(self, start):
        self.laws = [joystick_law(setting, noisy=False) for setting in SETTINGS]
        self.degrees = np.degrees(start)
        self.states = [law.initial(angle) for law, angle in zip(self.laws, self.degrees, strict=True)]
        self.lines = [[0.0] * setting.model.delay_samples for setting in SETTINGS]
        self.voltages, self.time = np.zeros(4), 0.0

    def advance(self, percent):
        for i, law in enumerate(self.laws):
            self.states[i], _, self.voltages[i] = law.step(self.states[i], percent[i], self.degrees[i])
            model = SETTINGS[i].model
            for _ in range(round(sample_s() / model.sample_s)):
                self.lines[i].append(self.voltages[i])
                self.degrees[i] = model.step(self.degrees[i], self.lines[i].pop(0))
        self.time += sample_s()
        return np.radians(self.degrees)


def trial(operator, goals, seed=1, start=START, most=400.0):
    joints = Joints(start)
    person = JoystickOperator(operator, goals, RATES, np.random.default_rng(seed))
    position, sticks = start, []
    while not person.finished and joints.time < most:
        sticks.append(person.deflection(joints.time, position))
        position = joints.advance(sticks[-1])
    return person, position, np.array(sticks), joints.time


def _goal(tolerance=0.01, posture=END, **named):
    return Goal(posture, LEVERS, tolerance, **named)


@pytest.mark.parametrize("name", ["inexperienced", "experienced"])
def test_the_goal_is_reached_and_no_two_valves_are_open_at_once(name):
    person, position, sticks, _ = trial(make_operator(name), [_goal()])
    assert person.finished
    assert np.linalg.norm(LEVERS * (position - END)) <= 0.010
    assert np.count_nonzero(sticks, axis=1).max() == 1
    np.testing.assert_array_equal(sticks[-1], 0.0)  # and it has let go


def test_time_falls_with_a_wider_tolerance():
    operator = make_operator("experienced")
    means = [
        np.mean([trial(operator, [_goal(tolerance)], seed)[3] for seed in range(4)])
        for tolerance in (0.005, 0.02, 0.08)
    ]
    assert means[0] > means[1] > means[2]


def test_one_long_move_takes_preparation_and_what_the_published_law_of_the_joint_gives():
    """One joint, no aiming error, wide tolerance: thought, dead time, way at the stick's speed."""
    operator = replace(make_operator("experienced"), most_deflection=100.0)
    posture = START + np.radians([30.0, 0.0, 0.0, 0.0])
    person, _, _, seconds = trial(operator, [_goal(0.08, posture)])
    (move,) = person.moves
    speed = RATES.smallest(0, 1.0, abs(move.aim - move.start) / 2.0, 100.0)[1]
    way = abs(move.aim - move.start) / speed
    looking = 0.1  # until the arm is seen to stand still, before and after
    expected = looking + preparation(operator, 2) + RATES.dead_time[0] + way + looking
    assert seconds == pytest.approx(expected, abs=4 * sample_s())


def test_one_who_does_not_know_the_dead_time_overshoots_by_it():
    posture = START + np.radians([30.0, 0.0, 0.0, 0.0])
    passed = {}
    for knows in (False, True):
        operator = replace(make_operator("experienced"), knows_dead_time=knows)
        person, position, *_ = trial(operator, [_goal(0.2, posture)])
        passed[knows] = np.degrees(position[0] - person.moves[0].aim)
    speed = np.degrees(RATES.smallest(0, 1.0, np.radians(30.0) / 2.0, 100.0)[1])
    assert passed[False] == pytest.approx(speed * RATES.dead_time[0], abs=speed * sample_s())
    assert abs(passed[True]) <= speed * sample_s()


def test_the_beginner_needs_longer():
    times = {
        name: np.mean([trial(make_operator(name), [_goal()], seed)[3] for seed in range(3)])
        for name in ("inexperienced", "experienced")
    }
    assert times["inexperienced"] > times["experienced"]


def test_the_smallest_deflection_that_is_used_is_beyond_the_dead_zone():
    for joint, setting in enumerate(SETTINGS):
        for sign in (-1.0, 1.0):
            percent, speed = RATES.smallest(joint, sign, 0.0, 100.0)
            voltage = setting.scaling.voltage(sign * percent)
            assert speed > 0.0 and setting.model.rate(voltage) * sign > 0.0


def test_a_press_that_came_short_is_followed_by_a_longer_one():
    operator = make_operator("experienced")
    person = JoystickOperator(
        operator, [_goal(1e-4, START + np.radians([1.0, 0, 0, 0]))], RATES, np.random.default_rng(1)
    )
    pressed, time = [], 0.0
    while len(pressed) < 400:
        pressed.append(person.deflection(time, START)[0])  # a joint that does not move
        time += 0.01
    lengths = [np.count_nonzero(part) for part in np.split(pressed, np.flatnonzero(np.diff(pressed)) + 1)]
    lengths = [length for length in lengths if length]
    assert len(lengths) >= 2 and lengths[1] > lengths[0]
    assert reaction_time() > 0.01 * lengths[0]  # shorter than a reaction: not led by sight


def test_a_joint_whose_way_is_not_free_is_left_for_later():
    blocked = [_goal(free=lambda first, second: second[1] > np.radians(30.0))]
    person, *_ = trial(make_operator("experienced"), blocked)
    assert person.finished and person.moves[0].joint == 1 and person.unseen_ways == 0


def test_a_joint_that_is_stopped_by_something_is_let_go():
    """As a jaw that closes on a pipe: the goal lies beyond what stops it."""
    beyond = START + np.radians([60.0, 0.0, 0.0, 0.0])  # the stop is at 40.6 deg
    person, position, sticks, seconds = trial(
        make_operator("experienced"), [_goal(0.01, beyond, until_still=True)]
    )
    assert person.finished and np.degrees(position[0]) == pytest.approx(40.6, abs=0.1)
    np.testing.assert_array_equal(sticks[-1], 0.0)
    assert seconds < 15.0
