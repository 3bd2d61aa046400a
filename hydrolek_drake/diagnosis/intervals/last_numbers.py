"""The numbers of the model that is named: fitted to the last square, and how far each of its effects' is known.

Fits that choose among models end where another step tells none of them from another. A number may be several of its
standard deviations from the bottom there, and where a joint sticks and slips or takes up a play, the curvature of a
local minimum says little of how far it reaches, and nothing of a deeper one beside it. So each number of the effects is
gone along on both sides, all others following, until the likelihood has fallen by what its interval allows; what lies
lower on the way is where the fit begins anew (profile likelihood: Raue et al., Bioinformatics 25, 2009, 1923).

The moment at which something happens, such as a load that is picked up, has no slope: within an integration step
residuals do not change with it at all, and from one move of the joint to the next they have local minima. So its
interval is that of the likelihood ratio over many moments.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from hydrolek_drake.diagnosis.evidence.judged import Judged
from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.intervals.curvature import (
    Interval,
    beyond_curvature,
    covariance_of,
    intervals_of,
)
from hydrolek_drake.diagnosis.intervals.step_error import without_step_error
from hydrolek_drake.diagnosis.settings import EVIDENCE, FITS
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis, moments_of
from hydrolek_drake.diagnosis.structures.weighing import felt_together
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.least_squares.profile import (
    SIDES,
    Begun,
    Profile,
    Side,
    profile_of,
    walked,
)
from hydrolek_drake.identification.least_squares.secant_descent import SecantDescent
from hydrolek_drake.identification.parameter_set import Free
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.identification.rolling import Request, residuals_at


class LastNumbers:
    """Fits one set of effects to the last square, joints that move together rolled out at once."""

    def __init__(self, bench: Workbench, hypothesis: Hypothesis) -> None:
        """Prepare.

        Args:
            bench: fits, and the training data.
            hypothesis: near its optimum.
        """
        self._bench = bench
        self._begun = hypothesis
        resolved = bench.step_for(hypothesis.effects)
        self._step = bench.fine if bench.together else min(hypothesis.step, FITS.last_step * resolved)
        self.problem = self._problem(bench.training)
        self._moving = bench.movable(hypothesis.effects, self.problem.parameters)
        self._descent = self._descending()

    def _descending(self) -> SecantDescent:
        return SecantDescent(
            self.problem,
            worth=EVIDENCE.worth,
            stop=self._bench.interrupted,
            moving=self._moving,
            slopes=self.problem.jacobian_without_jumps,
            least=EVIDENCE.renewed,
        )

    def _problem(self, experiments: Sequence[Experiment]) -> Problem:
        kind = ProblemTogether if self._bench.together else Problem
        return self._bench.problem(self._begun.effects, self._step, experiments, kind=kind)

    def found(self) -> tuple[Hypothesis, dict[str, Interval]]:
        """The fit, and the intervals of all its numbers, full path -> interval."""
        bench = self._bench
        fit = self._corrected(self._descent.from_start(self._begun.fit.unit))
        profiles = self._profiles(fit)
        for _ in range(FITS.anew):
            lowest = max(profiles, key=lambda p: p.improved, default=None)
            if lowest is None or lowest.improved < EVIDENCE.lower:
                break
            fit = self._descent.from_start(lowest.lowest)
            profiles = self._profiles(fit)
        bench.evaluations += self.problem.evaluations
        parameters = self.problem.parameters
        times = beyond_curvature(fit, self.problem.experiments)
        intervals = intervals_of(parameters, fit, times)
        for one in profiles:
            free, there = parameters.free[one.index], float(fit.unit[one.index])
            low, high = (
                free.from_unit(
                    end
                    if reached is None
                    else float(np.clip(there + times[one.index] * (reached - there), 0.0, 1.0))
                )
                for end, reached in ((0.0, one.low), (1.0, one.high))
            )
            known = intervals[free.path]
            intervals[free.path] = Interval(known.value, min(known.low, low), max(known.high, high))
        values = parameters.values(fit.unit)
        return Hypothesis(self._begun.effects, values, fit, self._step), intervals

    def _corrected(self, fit: Fit) -> Fit:
        """Fitted on without what the step adds; joints that move together keep it, whose rollouts are of one step."""
        bench = self._bench
        if bench.together:
            return fit
        there = Hypothesis(self._begun.effects, self.problem.parameters.values(fit.unit), fit, self._step)
        bench.evaluations += self.problem.evaluations
        self.problem = self._problem(without_step_error(self.problem, there, self._step, bench.training))
        self._descent = self._descending()
        corrected = self._descent.at(fit.unit)
        # what was taken out is the same at every place: the slopes are these still
        led = self._descent.led_by(fit.jacobian, corrected, self._moving)
        if corrected.objective - led.objective < EVIDENCE.renewed:
            return replace(led, slopes=fit.jacobian)
        return self._descent.from_start(led.unit)

    def _profiles(self, fit: Fit) -> list[Profile]:
        """Of each number of the effects that least squares moves and that the data tell."""
        covariance = covariance_of(fit)
        numbers = {free.path for effect in self._begun.effects for free in effect.free}
        told = [
            index
            for index, path in enumerate(self.problem.parameters.paths)
            if path in numbers and self._moving[index] and covariance[index, index] > 0.0
        ]
        begun = Begun.at(fit.unit, fit.residuals, fit.off_prior, self.problem.counted)
        sides = self._bench.side_by_side(
            lambda each: self._side(fit, begun, covariance, *each),
            [(index, s) for index in told for s in SIDES],
        )
        count = len(SIDES)
        return [
            profile_of(begun, index, sides[count * k : count * (k + 1)], EVIDENCE.confidence)
            for k, index in enumerate(told)
        ]

    def _side(self, fit: Fit, begun: Begun, covariance: np.ndarray, index: int, side: float) -> Side:
        """One side of one number's, the others led by the fit's Jacobian, which one elsewhere would hardly change."""
        along = covariance[:, index] / covariance[index, index]
        others = self._moving & (np.arange(fit.unit.size) != index)

        def following(start: np.ndarray) -> tuple[np.ndarray, float]:
            there = np.clip(fit.unit + (start[index] - fit.unit[index]) * along, 0.0, 1.0)
            there[index] = start[index]
            led = self._descent.led_by(fit.jacobian, self._descent.at(there), others)
            return led.unit, led.objective

        deviation = float(np.sqrt(covariance[index, index])) / max(1.0, fit.over_noise)
        return walked(
            begun,
            index,
            side,
            deviation,
            following,
            confidence=EVIDENCE.confidence,
            first=EVIDENCE.deviations,
        )

    def held_out_residuals(self, fitted: Hypothesis, held_out: Sequence[Experiment]) -> np.ndarray:
        """Residuals on the held-out data, in units of the noise, without what the step adds, as fitted. # (values,)."""
        told = held_out
        if not self._bench.together:
            told = without_step_error(self.problem, fitted, self._step, held_out)
        return self._problem(told).residuals(fitted.fit.unit)


def with_last_numbers(
    bench: Workbench, best: Judged, held_out: Sequence[Experiment]
) -> tuple[Judged, dict[str, Interval], tuple[Experiment, ...]]:
    """The model that is named, with its last numbers.

    Args:
        bench: fits, and the training data, which are told anew where joints move together.
        best: the model, as it was judged.
        held_out: what decided.

    Returns:
        The model; full path -> interval of every number; and the held-out data, told anew as the training data.
    """
    last = LastNumbers(bench, best.hypothesis)
    there, intervals = last.found()
    rig = bench.rig.with_values(there.values)
    training, told = felt_together(rig, bench.training), felt_together(rig, held_out)
    ahead = last.held_out_residuals(there, told)
    bench.training = tuple(training)  # an interrupt before leaves all as it was
    return replace(best, hypothesis=there, held_out=ahead), intervals, tuple(told)


def intervals_of_moments(bench: Workbench, hypothesis: Hypothesis) -> dict[str, Interval]:
    """Full path -> moment with its 95 % interval: all moments that the residuals do not tell from the best one.

    A moment has no slope, so its interval is that of the likelihood ratio, all else changed along its tangents (Seber,
    Wild, Nonlinear Regression, 1989, chapter 5).

    Args:
        bench: data and problems.
        hypothesis: a fitted model.
    """
    found = {}
    for free in moments_of(hypothesis.effects):
        value, apart = hypothesis.values[free.path], (free.upper - free.lower) / EVIDENCE.moments
        tried = np.linspace(free.lower, free.upper, EVIDENCE.moments + 1)
        near = np.clip(
            value + apart * np.linspace(-2.0, 2.0, 4 * EVIDENCE.closer + 1), free.lower, free.upper
        )
        moments = np.unique([*tried, *near, value])
        errors = _errors(bench, hypothesis, free, moments)
        unlike = chi2.ppf(EVIDENCE.confidence, 1) * max(1.0, hypothesis.fit.over_noise) ** 2
        alike = np.flatnonzero(errors <= errors.min() + unlike)
        low, high = max(alike[0] - 1, 0), min(alike[-1] + 1, len(moments) - 1)
        found[free.path] = Interval(value, min(moments[low], value), max(moments[high], value))
    return found


def _errors(bench: Workbench, hypothesis: Hypothesis, free: Free, moments: np.ndarray) -> np.ndarray:
    """Squared residuals that each moment leaves after the best change of all else. # (moments,)."""
    problem = bench.problem(hypothesis.effects, bench.step_for(hypothesis.effects))
    across, off = Across(hypothesis.fit), hypothesis.fit.off_prior
    units = [problem.parameters.unit({**hypothesis.values, free.path: moment}) for moment in moments]
    [found] = residuals_at([Request(problem, tuple(units))], bench.pool, bench.cores)
    left = [across(np.concatenate([residuals, off])) for residuals in found]
    return np.nan_to_num(np.array([float(each @ each) for each in left]), nan=np.inf)
