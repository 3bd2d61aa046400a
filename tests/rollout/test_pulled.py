"""Rollouts that are pulled to what was measured: an observer that forgets its errors at the rate it is told."""

import math

import numpy as np
import pytest

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import roll_out

TIMES = np.arange(0.0, 4.0, 0.01)
COMMAND = np.where(TIMES < 0.5, 0.0, np.where(TIMES < 2.0, 6.0, -6.0))
STEP = 5e-4


def _run(values=None, pull=None, command=COMMAND, state=None):
    records = load_rig("joint_bench", {}).with_values(values or {}).records()
    return roll_out(records, TIMES, command, TIMES, longest_step=STEP, pull=pull, state=state).signals


def _measured(signals) -> np.ndarray:
    return np.stack([getattr(signals, name) for name in PULLED], axis=1)


def _rms(series) -> float:
    return float(np.sqrt(np.mean(np.square(series))))


def test_a_model_that_is_right_is_not_pulled() -> None:
    free = _run()
    assert _run(pull=(0.05, _measured(free))).reading.tobytes() == free.reading.tobytes()


def test_a_wrong_start_is_forgotten_with_the_time_constant() -> None:
    closed = np.zeros(TIMES.size)
    right = _run(command=closed)
    record = load_rig("joint_bench", {}).records()
    off = math.radians(3.0)
    wrong = rest_state(record, float(right.position[0]) + off)
    only_angle = _measured(right)
    only_angle[:, 1:] = np.nan
    pulled = _run(command=closed, pull=(0.2, only_angle), state=wrong)
    # the closed valves hold whatever place the joint is moved to, so that only the pull moves it
    left = (pulled.position - right.position)[:100] / off
    assert left == pytest.approx(np.exp(-TIMES[:100] / 0.2), abs=0.05)


def test_errors_do_not_pile_up_in_a_pulled_rollout() -> None:
    measured = _run({"valve.max_area_a": 0.75e-6, "valve.max_area_b": 0.75e-6})
    free, pulled = _run(), _run(pull=(0.1, _measured(measured)))
    speed_error = np.abs(np.gradient(free.reading - measured.reading, TIMES)).max()
    assert _rms(pulled.reading - measured.reading) < 0.2 * _rms(free.reading - measured.reading)
    assert np.abs(pulled.reading - measured.reading).max() < 1.5 * 0.1 * speed_error


def test_gaps_in_what_was_measured_leave_the_rollout_free() -> None:
    nothing = np.full((TIMES.size, len(PULLED)), np.nan)
    assert _run(pull=(0.1, nothing)).reading.tobytes() == _run().reading.tobytes()
