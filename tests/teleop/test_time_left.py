"""The time that a task still takes, at the pace at which the plant runs."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.machine_state import MachineState
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.teleop.time_left import TimeLeft

SETTLED = teleop_entries("task")["settled"]


def _plan(*durations):
    def step(seconds):
        return SimpleNamespace(trajectory=SimpleNamespace(end_time=lambda: seconds))

    return SimpleNamespace(steps=tuple(step(seconds) for seconds in durations))


def _state(mode, number, seconds):
    still = np.zeros(14)
    return MachineState(mode, "", number, seconds, 20.0, still, still, True, "")


def test_on_a_plant_at_a_third_of_real_time_the_rest_takes_three_times_as_planned():
    now = [100.0]
    left = TimeLeft(_plan(20.0, 40.0), clock=lambda: now[0])
    assert left.told(_state(Mode.RUNNING, 0, 0.0)) == (0.0, None)
    for seconds in np.arange(0.1, 15.0, 0.1):
        now[0] += 0.1 * 3.0
        share, rest = left.told(_state(Mode.RUNNING, 0, float(seconds)))
    whole = 60.0 + 2.0 * SETTLED
    assert share == pytest.approx(14.9 / whole)
    assert rest == pytest.approx(3.0 * (whole - 14.9), rel=1e-6)


def test_a_pace_that_changes_is_followed_and_a_stop_counts_for_nothing():
    now = [0.0]
    left = TimeLeft(_plan(100.0), clock=lambda: now[0])
    for number in range(200):
        now[0] += 0.1
        left.told(_state(Mode.RUNNING, 0, 0.1 * number))
    now[0] += 3600.0  # stopped for an hour
    _, standing = left.told(_state(Mode.STOPPED, 0, 20.0))
    now[0] += 0.1
    _, resumed = left.told(_state(Mode.RUNNING, 0, 20.0))
    assert resumed == pytest.approx(standing) == pytest.approx(80.0 + SETTLED, rel=0.02)
    for number in range(400):
        now[0] += 0.2  # half as fast from here
        _, rest = left.told(_state(Mode.RUNNING, 0, 20.0 + 0.1 * number))
    assert rest == pytest.approx(2.0 * (100.0 + SETTLED - 59.9), rel=0.02)


def test_at_its_end_nothing_is_left():
    left = TimeLeft(_plan(5.0))
    assert left.told(_state(Mode.DONE, 0, 5.0)) == (1.0, 0.0)
