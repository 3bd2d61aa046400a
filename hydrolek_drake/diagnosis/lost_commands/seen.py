"""Windows in which commands may have got lost, read from the unknown input that is added to the command."""

from collections.abc import Mapping

import numpy as np

from hydrolek_drake.diagnosis.laws.inputs import Input
from hydrolek_drake.diagnosis.laws.terms import Span
from hydrolek_drake.diagnosis.locating.unknown_input import SPACING_S, Unknown, near, unknown_inputs
from hydrolek_drake.diagnosis.lost_commands.windows import (
    LONGEST_S,
    NONE,
    SHORTEST_S,
    LostWindows,
    Windows,
    in_order,
    joined,
    recording_of,
    too_much,
)
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

WINDOWS = (0, 1, 2, 4)
"""Spacings of the knots that a window spans beyond the two slopes at its ends: from 0.05 to 0.25 s."""

GAIN = 25.0
"""Fall of the squares, over what is left of each value on average, that a window must promise: five standard
deviations, since hundreds are tried."""

REMEMBERS_S = 3.0
"""Time constant of the observer [s]. A joint that misses its command for a few milliseconds is off by little, and for
good: a fast observer forgets it before it can be told from noise."""

WHOLE = 1.2
"""Multiple of a command that may be missing: there is no more in it to be lost but for the observer's own error."""


def lost_seen(
    bench: Workbench,
    structure: Hypothesis,
    command: Input,
    neutral: float,
    known: Mapping[str, Windows],
    span: Span,
    cores: int,
    values: dict[str, float] | None = None,
) -> LostWindows | None:
    """Windows that explain most of a slow observer's innovations, beside those that are known.

    Windows are picked one after the other (matching pursuit; Pati,
    Rezaiifar, Krishnaprasad, 27th Asilomar Conference on Signals, Systems and Computers, 1993).

    Args:
        bench: training data of one joint.
        structure: fitted to them, or to others.
        command: what is added to the command.
        neutral: command that acts while one is lost [V].
        known: recording -> windows that the structure has.
        span: what laws of the joint are told in.
        cores: that roll out at the same time.
        values: full path -> where the structure's parameters stand; None for where innovations are small.

    Returns:
        All windows; None where there are none beyond the known ones, or more of a recording would be lost than can be.
    """
    around = values or near(bench, structure, REMEMBERS_S, cores)
    [unknown] = unknown_inputs(bench, structure, around, [command], REMEMBERS_S, cores).unknowns
    experiments = bench.training
    firsts = [0, *(np.flatnonzero(np.diff(unknown.times) < 0.0) + 1), unknown.times.size]
    missing = np.concatenate(
        [
            neutral - _command_at(experiment, unknown.times[a:b])
            for experiment, a, b in zip(experiments, firsts[:-1], firsts[1:], strict=True)
        ]
    )
    counted = sum(e.counted for e in experiments)
    chosen, taken = _picked(unknown, missing / command.scale, counted)
    share = min(taken / max(unknown.left - counted, 1.0), 1.0)
    seen = {}
    for experiment, first, last in zip(experiments, firsts[:-1], firsts[1:], strict=True):
        own = []
        for knot, spacings, multiple in chosen:
            if first <= knot < last:
                length = min(multiple * (spacings + 1) * SPACING_S, LONGEST_S)
                middle = float(unknown.times[knot]) + 0.5 * spacings * SPACING_S
                own.append((middle - 0.5 * length, middle + 0.5 * length))
        before = known.get(recording_of(experiment), NONE)
        seen[recording_of(experiment)] = joined(in_order(before, np.array(sorted(own)).reshape(-1, 2)))
        if too_much(seen[recording_of(experiment)], experiment):
            return None
    if not chosen or not any(len(windows) for windows in seen.values()):
        return None
    return LostWindows(experiments[0].joint, command, neutral, seen, span, share)


def _picked(
    unknown: Unknown, missing: np.ndarray, counted: int
) -> tuple[list[tuple[int, int, float]], float]:
    """Windows that promise most: first knot, spacings, and how much of the command they take; and what all promise."""
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
    powers = np.maximum(np.einsum("ik,ik->k", courses, changes), np.finfo(float).tiny)
    pull, left = unknown.pull.copy(), unknown.left
    chosen: dict[int, float] = {}
    for _ in range(size):
        along = -(courses.T @ pull)
        multiples = np.clip(along / powers, 0.0, WHOLE)
        gains = multiples * (2.0 * along - multiples * powers)
        gains[list(chosen)] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAIN * max(left / max(counted, 1), 1.0):
            break
        chosen[best] = float(multiples[best])
        pull = pull + changes[:, best] * multiples[best]
        left -= float(gains[best])
    shortest = SHORTEST_S / SPACING_S
    windows = [
        (which % size, WINDOWS[which // size], multiple)
        for which, multiple in chosen.items()
        if multiple > shortest
    ]
    return windows, unknown.left - left


def _command_at(experiment: Experiment, times: np.ndarray) -> np.ndarray:
    """The command in force at some times [V]."""
    held = np.searchsorted(experiment.command_times, times, side="right") - 1
    return np.asarray(experiment.command[np.maximum(held, 0)])
