"""Whether commands that got lost on their way would explain what an observer saw."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.locating.unknown_input import Unknown
from hydrolek_drake.identification.experiment import Experiment

WINDOWS = (0, 1, 2, 4)
"""Spacings of the knots that a window spans beyond the two slopes at its ends: from 0.05 to 0.25 s."""

GAIN = 25.0
"""Fall of the squares, over what is left of each value on average, that a window must promise: five standard
deviations, since hundreds are tried."""

WHOLE = 1.2
"""Multiple of a command that may be missing: there is no more in it to be lost but for the observer's own error."""


def share_lost(unknown: Unknown, experiments: Sequence[Experiment], neutral: float, counted: int) -> float:
    """Which share of what is left above the noise windows without a command take.

    Windows are picked one after the other that explain most (matching pursuit; Pati, Rezaiifar, Krishnaprasad, 27th
    Asilomar Conference on Signals, Systems and Computers, 1993).

    Args:
        unknown: what innovations tell of an input that is added to the command.
        experiments: recordings, in the order of its knots.
        neutral: command that acts while one is lost [V].
        counted: how many values count.
    """
    firsts = [0, *(np.flatnonzero(np.diff(unknown.times) < 0.0) + 1), unknown.times.size]
    missing = np.concatenate(
        [
            neutral - _command_at(experiment, unknown.times[a:b])
            for experiment, a, b in zip(experiments, firsts[:-1], firsts[1:], strict=True)
        ]
    )
    missing = missing / unknown.input.scale
    size = missing.size
    knots = np.arange(size)[:, None]
    courses = np.concatenate(
        [
            np.where((knots >= knots.T) & (knots <= knots.T + length), missing[:, None], 0.0)
            for length in WINDOWS
        ],
        axis=1,
    )
    changes = unknown.information @ courses
    powers = np.einsum("ik,ik->k", courses, changes)
    pull, left, taken = unknown.pull.copy(), unknown.left, 0.0
    chosen = np.zeros(courses.shape[1], dtype=bool)
    for _ in range(size):
        along = -(courses.T @ pull)
        multiples = np.clip(along / np.maximum(powers, np.finfo(float).tiny), 0.0, WHOLE)
        gains = multiples * (2.0 * along - multiples * powers)
        gains[chosen] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAIN * max(left / max(counted, 1), 1.0):
            break
        chosen[best] = True
        pull = pull + changes[:, best] * multiples[best]
        left -= float(gains[best])
        taken += float(gains[best])
    excess = unknown.left - counted
    return min(taken / excess, 1.0) if excess > 0.0 else 0.0


def _command_at(experiment: Experiment, times: np.ndarray) -> np.ndarray:
    """The command in force at some times [V]."""
    held = np.searchsorted(experiment.command_times, times, side="right") - 1
    return np.asarray(experiment.command[np.maximum(held, 0)])
