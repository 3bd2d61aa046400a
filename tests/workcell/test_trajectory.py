"""Time along a path: through every posture, within speed and acceleration, as fast as the slowest joint allows."""

import itertools

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.workcell.trajectory import joint_speeds, smooth_trajectory, time_parametrised


@pytest.fixture
def path():
    return np.cumsum(np.random.default_rng(1).normal(0, 0.3, (6, 14)), axis=0)


def test_speed_and_acceleration_stay_within_limits_and_one_reaches_its_limit(path):
    trajectory = time_parametrised(path)
    times = np.linspace(0, trajectory.end_time(), 3000)
    speed, acceleration = joint_speeds()
    speeds = np.array([trajectory.EvalDerivative(t, 1)[:, 0] for t in times])
    accelerations = np.array([trajectory.EvalDerivative(t, 2)[:, 0] for t in times])
    assert np.all(np.abs(speeds) <= speed * (1 + 1e-9))
    assert np.all(np.abs(accelerations) <= acceleration * (1 + 1e-9))
    assert max(np.max(np.abs(speeds) / speed), np.max(np.abs(accelerations) / acceleration)) > 0.99
    np.testing.assert_allclose(speeds[[0, -1]], 0.0, atol=1e-9)


def test_trajectory_stays_on_the_straight_stretches_of_the_path(path):
    trajectory = time_parametrised(path)
    corners = [trajectory.value(t)[:, 0] for t in trajectory.get_segment_times()]
    np.testing.assert_allclose(corners, path, atol=1e-12)
    for t in np.linspace(0, trajectory.end_time(), 200):
        posture = trajectory.value(t)[:, 0]
        off = []
        for a, b in itertools.pairwise(path):
            share = np.clip((posture - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
            off.append(np.linalg.norm(posture - a - share * (b - a)))
        assert min(off) < 1e-9


def test_a_single_long_move_takes_the_closed_form_s_time():
    """Cubic 3 s^2 - 2 s^3: peak speed 1.5 L / T, peak acceleration 6 L / T^2."""
    path = np.zeros((2, 14))
    path[1, 1] = 1.0
    speed, acceleration = joint_speeds()
    expected = max(1.5 / speed[1], np.sqrt(6 / acceleration[1]))
    assert time_parametrised(path).end_time() == pytest.approx(expected)


def test_standing_still_takes_no_time_and_wrong_shapes_are_refused():
    """No more than a period: a step waits for the end of its path."""
    for postures in (1, 3):
        assert 0.0 < time_parametrised(np.ones((postures, 14))).end_time() <= 0.05
        np.testing.assert_allclose(time_parametrised(np.ones((postures, 14))).value(0.02)[:, 0], 1.0)
    with pytest.raises(InputError, match="14 joints"):
        time_parametrised(np.zeros((3, 7)))


def test_smooth_trajectory_passes_every_posture_without_stopping_and_keeps_the_limits():
    share = np.linspace(0, 1, 12)[:, np.newaxis]
    path = 0.4 * share + 0.1 * np.sin(2 * share + np.arange(14))
    trajectory = smooth_trajectory(path)
    corners = [trajectory.value(t)[:, 0] for t in trajectory.get_segment_times()]
    np.testing.assert_allclose(corners, path, atol=1e-12)
    speed, acceleration = joint_speeds()
    times = np.linspace(0, trajectory.end_time(), 3001)
    speeds = np.array([trajectory.EvalDerivative(t, 1)[:, 0] for t in times])
    accelerations = np.array([trajectory.EvalDerivative(t, 2)[:, 0] for t in times])
    assert np.all(np.abs(speeds) <= speed) and np.all(np.abs(accelerations) <= acceleration)
    np.testing.assert_allclose(speeds[[0, -1]], 0.0, atol=1e-9)
    assert np.abs(speeds[300:-300]).max(axis=1).min() > 0.02  # moving all along
    assert trajectory.end_time() < time_parametrised(path).end_time() / 1.5
