"""Windows in which commands may have got lost, read from the unknown input that is added to the command."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from hydrolek_drake.diagnosis.locating.unknown_input import Unknown, near, unknown_inputs
from hydrolek_drake.diagnosis.settings import DROPOUTS, GAINS
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.lost_windows import (
    NONE,
    LostWindows,
    Windows,
    in_order,
    joined,
    recording_of,
    too_much,
)
from hydrolek_drake.diagnosis.structures.term_forms import Span
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.rollout.run import Run


@dataclass(frozen=True)
class Lost:
    """A command that is lost from a knot to the next: the valve answers to all of it, which no small input tells."""

    input: Input
    neutral: float
    share: ClassVar[float] = 1.0
    spacing_s: ClassVar[float] = DROPOUTS.sample_s

    def run(
        self, experiment: Experiment, records: np.ndarray, step: float, pull: float | None, moved: np.ndarray
    ) -> Run:
        """See `knot_responses.Trial`."""
        begins = experiment.time[0] + DROPOUTS.sample_s * np.flatnonzero(moved)
        windows = np.stack([begins, begins + DROPOUTS.sample_s], axis=1)
        return experiment.without_command(windows, self.neutral).run(records, step, pull_time=pull)


def lost_seen(
    bench: Workbench,
    structure: Hypothesis,
    command: Input,
    neutral: float,
    known: Mapping[str, Windows],
    span: Span,
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
        values: full path -> where the structure's parameters stand; None for where innovations are small.

    Returns:
        All windows; None where there are none beyond the known ones, or more of a recording would be lost than can be.
    """
    around = values or near(bench, structure, DROPOUTS.remembers_s)
    trials = [Lost(command, neutral)]
    [unknown] = unknown_inputs(bench, structure, around, trials, DROPOUTS.remembers_s).unknowns
    experiments = bench.training
    firsts = [0, *(np.flatnonzero(np.diff(unknown.times) < 0.0) + 1), unknown.times.size]
    counted = sum(e.counted for e in experiments)
    chosen, taken = _picked(unknown, counted)
    share = min(taken / max(unknown.left - counted, 1.0), 1.0)
    seen = {}
    for experiment, first, last in zip(experiments, firsts[:-1], firsts[1:], strict=True):
        own = []
        for knot, spacings, multiple in chosen:
            if first <= knot < last:
                length = min(multiple * spacings * DROPOUTS.sample_s, DROPOUTS.longest_s)
                middle = float(unknown.times[knot]) + 0.5 * spacings * DROPOUTS.sample_s
                own.append((middle - 0.5 * length, middle + 0.5 * length))
        before = known.get(recording_of(experiment), NONE)
        seen[recording_of(experiment)] = joined(in_order(before, np.array(sorted(own)).reshape(-1, 2)))
        if too_much(seen[recording_of(experiment)], experiment):
            return None
    if not chosen or not any(len(windows) for windows in seen.values()):
        return None
    return LostWindows(experiments[0].joint, command, neutral, seen, span, share)


def _picked(unknown: Unknown, counted: int) -> tuple[list[tuple[int, int, float]], float]:
    """Windows that promise most: first knot, spacings, and which share of them is lost; and what all promise."""
    size = unknown.times.size
    firsts, spacings = (
        grid.ravel() for grid in np.meshgrid(np.arange(size), np.arange(1, DROPOUTS.most_knots + 1))
    )
    inside = firsts + spacings <= size
    firsts, spacings = firsts[inside], spacings[inside]
    ends = firsts + spacings
    sums = np.pad(unknown.information.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    powers = sums[ends, ends] - sums[firsts, ends] - sums[ends, firsts] + sums[firsts, firsts]
    powers = np.maximum(powers, np.finfo(float).tiny)
    pull, left = unknown.pull.copy(), unknown.left
    chosen: dict[int, float] = {}
    for _ in range(size):
        sum_of_pull = np.concatenate([[0.0], pull.cumsum()])
        along = sum_of_pull[firsts] - sum_of_pull[ends]
        multiples = np.clip(along / powers, 0.0, DROPOUTS.whole)
        gains = multiples * (2.0 * along - multiples * powers)
        gains[list(chosen)] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAINS.certain**2 * max(left / max(counted, 1), 1.0):
            break
        chosen[best] = float(multiples[best])
        own = slice(firsts[best], ends[best])
        pull = pull + unknown.information[:, own].sum(axis=1) * multiples[best]
        left -= float(gains[best])
    windows = [
        (int(firsts[which]), int(spacings[which]), multiple)
        for which, multiple in chosen.items()
        if multiple * DROPOUTS.sample_s > DROPOUTS.shortest_s
    ]
    return windows, unknown.left - left
