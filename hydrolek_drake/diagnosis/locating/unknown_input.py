"""An unknown input at each stage, estimated from the innovations of an observer.

An input u(t) on straight lines between knots changes the innovations by A u, with a small u (`knot_responses`). What
the structure's own parameters undo is projected away. With r the innovations, g = A' r, N = A' A and a prior of
variance s^2 for each knot

    u = -(N + I / s^2)^-1 g
    2 log p(r) - 2 log p0(r) = g' (N + I / s^2)^-1 g - log det (I + s^2 N)

(ridge regression and its marginal likelihood; MacKay, Bayesian interpolation, Neural Computation 4, 1992). The most
likely s is taken, and stages are compared by that likelihood.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of
from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.locating.knot_responses import Trial, response, rolled, squared
from hydrolek_drake.diagnosis.settings import FITS, LOCATING
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.inputs import Input
from hydrolek_drake.diagnosis.structures.law_terms import of_additions
from hydrolek_drake.diagnosis.structures.lost_windows import arrivals
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend, with_slopes
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.rollout.rollout import Signals


@dataclass(frozen=True)
class Unknown:
    """An unknown input and what the innovations tell of it.

    Attributes:
        input: where it enters, and as what.
        times: knots of each recording one after the other [s]. # (k,)
        information: N of the module, in units of the trial. # (k, k)
        pull: A' r. # (k,)
        left: r' r of what the structure's own parameters do not undo.
    """

    input: Input
    times: np.ndarray
    information: np.ndarray
    pull: np.ndarray
    left: float

    def gain_of(self, course: np.ndarray) -> tuple[float, float]:
        """Fall of the squares if the input takes a course's best multiple, and that, in scales of the input.

        Args:
            course: at the knots. # (k,)
        """
        power = float(course @ self.information @ course)
        along = -float(self.pull @ course)
        return (along * along / power, along / power) if power > 0.0 else (0.0, 0.0)

    def gains_of_pairs(self, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The same of two courses at once, such as a sine and a cosine, for many such pairs.

        Args:
            first: one of each pair, at the knots. # (k, pairs)
            second: the other one. # (k, pairs)

        Returns:
            Falls of the squares # (pairs,), and multiples of both # (pairs, 2).
        """
        both = np.stack([first, second])  # (2, k, pairs)
        square = np.einsum("akp,bkp->pab", both, self.information @ both)
        along = -np.einsum("akp,k->pa", both, self.pull)
        multiples = np.einsum("pab,pb->pa", np.linalg.pinv(square, rcond=1e-10, hermitian=True), along)
        return np.einsum("pa,pa->p", along, multiples), multiples

    def estimated(self) -> "Estimate":
        """The input's most likely course."""
        values, vectors = np.linalg.eigh(self.information)
        values = np.maximum(values, 0.0)
        turned = vectors.T @ self.pull
        nothing = Estimate(self, np.zeros_like(self.pull), np.zeros_like(self.pull), 0.0)
        top = float(values[-1])
        if not top > 0.0:  # a part that a recording stands for
            return nothing
        best: tuple[float, float] = (0.0, 0.0)
        for variance in np.geomspace(1e-4, 1e6, 41) / top:
            gain = float(np.sum(turned**2 / (values + 1.0 / variance))) - float(
                np.sum(np.log1p(variance * values))
            )
            if gain > best[0]:
                best = (gain, variance)
        gain, variance = best
        if variance == 0.0:
            return nothing
        course = -vectors @ (turned / (values + 1.0 / variance))
        deviation = np.sqrt(np.sum(vectors**2 / (values + 1.0 / variance), axis=1))
        return Estimate(self, course * self.input.scale, deviation * self.input.scale, gain)


@dataclass(frozen=True)
class Estimate:
    """The most likely course of an unknown input.

    Attributes:
        unknown: what it is of.
        course: at the knots (SI). # (k,)
        deviation: its standard deviation. # (k,)
        evidence: twice the logarithm of how much likelier the innovations are with it.
    """

    unknown: Unknown
    course: np.ndarray
    deviation: np.ndarray
    evidence: float

    @property
    def explained(self) -> float:
        """Share of the squared innovations that it takes."""
        course = self.course / self.unknown.input.scale
        fall = -2.0 * self.unknown.pull @ course - course @ self.unknown.information @ course
        return float(np.clip(fall / self.unknown.left, 0.0, 1.0))


@dataclass(frozen=True)
class Seen:
    """What an observer around a structure saw.

    Attributes:
        unknowns: of each input.
        signals: of the rollouts that follow what was measured, of each recording.
    """

    unknowns: tuple[Unknown, ...]
    signals: tuple[Signals, ...]


def near(bench: Workbench, structure: Hypothesis, observer_s: float) -> dict[str, float]:
    """Full path -> value of a structure's parameters where an observer's innovations are small.

    A structure that lacks something has bent its numbers, and the rig's own may be far off: the fit begins at both.

    Args:
        bench: data and problems.
        structure: whose additions begin where they were fitted.
        observer_s: time constant of the observer [s].
    """
    problem = bench.problem(
        structure.effects, bench.step_for(structure.effects, LOCATING.coarse), bench.training, observer_s
    )
    moving = bench.movable(structure.effects, problem.parameters)
    starts = [
        problem.parameters.unit(of_additions(structure.values)),
        problem.parameters.unit(structure.values),
    ]
    begun = [
        Place(problem, moving, np.clip(start, FITS.negligible, 1.0 - FITS.negligible)) for start in starts
    ]
    ended = descend(begun, LOCATING.fitted, bench.pool, bench.cores)
    return problem.parameters.values(min(ended, key=lambda place: place.objective).unit)


def unknown_inputs(
    bench: Workbench, parent: Hypothesis, values: dict[str, float], trials: Sequence[Trial], observer_s: float
) -> Seen:
    """What the innovations around a structure tell of each input.

    Args:
        bench: data and problems.
        parent: the structure.
        values: full path -> where its parameters stand.
        trials: inputs of the joint, as they are moved.
        observer_s: time constant of the observer [s]; infinite for free rollouts, of which each knot takes one.
    """
    step = bench.step_for(parent.effects, LOCATING.coarse)
    pulled = None if math.isinf(observer_s) else observer_s
    problem = bench.problem(parent.effects, step, bench.training, pulled)
    arrived = arrivals(parent.effects, values, bench.training)
    place = Place(problem, bench.movable(parent.effects, problem.parameters), problem.parameters.unit(values))
    place = with_slopes([place], bench.pool, bench.cores, 1.0)[0]
    assert place.residuals is not None and place.slopes is not None
    fit = hypothesis_of(parent.effects, place, step).fit
    object.__setattr__(fit, "slopes", place.slopes)
    basis = Across(fit).basis[: place.residuals.size]
    rest = place.residuals - basis @ (basis.T @ place.residuals)
    records = problem.parameters.records(place.unit)
    here = rolled([e.run(records, step, pull_time=pulled) for e in arrived], bench.pool)
    at_rest = [e.residuals(each) for e, each in zip(arrived, here, strict=True)]
    unknowns = []
    for trial in trials:
        parts, times = [], []
        for experiment, still in zip(arrived, at_rest, strict=True):
            columns, knots = response(bench.pool, experiment, records, step, observer_s, trial, still)
            parts.append(columns)
            times.append(knots)
        rows = np.cumsum([0, *(part.shape[0] for part in parts)])
        information = np.zeros((sum(part.shape[1] for part in parts),) * 2)
        pull = np.zeros(len(information))
        inner = np.zeros((basis.shape[1], len(information)))
        at = 0
        for part, first in zip(parts, rows, strict=False):
            own = slice(at, at + part.shape[1])
            information[own, own] = squared(part)
            pull[own] = part.T @ rest[first : first + part.shape[0]]
            inner[:, own] = (part.T @ basis[first : first + part.shape[0]]).T
            at += part.shape[1]
        information -= inner.T @ inner
        unknowns.append(Unknown(trial.input, np.concatenate(times), information, pull, float(rest @ rest)))
    return Seen(tuple(unknowns), tuple(here))
