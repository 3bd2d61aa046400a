"""States that are moved towards what was measured, from outside the loops that integrate them."""

import math

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import sensor
from hydrolek_drake.rollout.joint_rows import PLAY, STATE, put_state, state_at
from hydrolek_drake.rollout.kernel import pulled
from hydrolek_drake.rollout.rest import START_STEPS


@njit(cache=True)
def pull_all(rows: np.ndarray, spans: np.ndarray, told: np.ndarray, measured: np.ndarray) -> None:
    """Pull joints that move together to what was measured, as `kernel.integrate` does with one before it moves on.

    Args:
        rows: of `joint_rows.room`, with `STATE` and `PLAY`.
        spans: how far the next move goes, in time constants of each joint's pull, shape (n,).
        told: their signals now, before the pull, shape (n, at least 1), the reading first.
        measured: `kernel.PULLED` of them, NaN where there is no value, shape (n, 3).
    """
    for i in range(len(rows)):
        share = 1.0 - math.exp(-spans[i])
        s, by = pulled(state_at(rows, i, STATE), share, told[i, 0], measured[i])
        put_state(rows, i, STATE, s)
        rows[i, PLAY] += by


def state_at_reading(joint: np.ndarray, state: np.ndarray, reading: float) -> np.ndarray:
    """A state, such as an observer's, moved to where the sensor reads a value [rad or m]; all else stays as it is.

    Args:
        joint: parameter record, shape (1,).
        state: as of `kernel.integrate`, shape (17,).
        reading: what was measured [rad or m].
    """
    there = state.copy()
    _move_to_reading(joint, float(reading), there)
    return there


@njit(cache=True)
def _move_to_reading(joints: np.ndarray, reading: float, state: np.ndarray) -> None:
    for _ in range(START_STEPS):
        off = reading - sensor.reading(state[11], state[12], joints[0])
        if off == 0.0:
            break
        state[4] += off
        state[9] += off
        state[11] += off
