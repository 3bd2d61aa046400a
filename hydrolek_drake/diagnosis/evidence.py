"""Which hypothesis is right, judged on data that none of them was fitted to.

The training data leave a hypothesis's parameters uncertain by a covariance S. To first order the held-out
residuals r of a model that is right then have the covariance I + J S J', J their Jacobian, and their
log-likelihood is

    -1/2 r' (I + J S J')^-1 r - 1/2 log det (I + J S J')

(predictive likelihood; MacKay, Bayesian interpolation, Neural Computation 4, 1992). To it comes the likelihood of
the training data at the optimum; both pay a cost for every effect and parameter, and all is divided by tau. Where
what the best model leaves exceeds the noise even so, something systematic is left, and tau is that excess for each
parameter: differences of that size do not decide (quasi-likelihood, McCullagh, Nelder, Generalized Linear Models,
1989, chapter 9). Probabilities are the normalised exponentials (Bayes with equal odds for all hypotheses of the same
number of effects).
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, AT_NOISE, NEAR, NEARLY, POLISH
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED, cost_of, gain_needed
from hydrolek_drake.diagnosis.judged import SMALL, Judged, dispersion, with_probabilities
from hydrolek_drake.diagnosis.lessening import slightly_worse
from hydrolek_drake.diagnosis.workbench import SPREAD, Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import Fit

FINER = 0.5
"""Last fits use this fraction of the rig's own step, so that the step's error cannot decide."""

FINISH = 4
"""Trust-region steps of the last fits, which begin at the optimum of the rig's own step."""

UNFINISHED = 1.0
"""A last fit that lowered the squared residuals by more than this, half a log-odds unit, may not have ended ..."""

NEAR_BEST = 30.0
"""... and goes on if its cost is within this of the least: a factor e^15 of probability."""

FURTHER = 4
"""At most so many times."""

CONTENDERS = 8
"""At most so many hypotheses are fitted with the finer step."""

NEARBY = 100.0
"""If uncertain parameters account for more than this of the held-out squared residuals, they have to move so far that
the first order may not hold: r' (I + J S J')^-1 r is then what both data leave, fitted together, beyond what the
training data leave alone."""

OUT_OF_REACH = 150.0
"""Half the squared residuals by which a hypothesis is beyond all doubt behind the best."""


def even(bench: Workbench, found: Search, held_out: Sequence[Experiment]) -> None:
    """Fit what contenders hardly surpass again, from where they ended, see `lessening.slightly_worse`.

    Args:
        bench: fits, to the training data as they were searched.
        found: hypotheses; the better fits are kept in it.
        held_out: recordings that nothing was fitted to; they tell the contenders.
    """
    contenders = _contenders(_looked_at(bench, list(found.hypotheses.values()), held_out), found)
    for hypothesis in slightly_worse(bench, contenders, found.hypotheses):
        found.keep(hypothesis)


def judge(bench: Workbench, found: Search, held_out: Sequence[Experiment]) -> list[Judged]:
    """Hold the hypotheses of a search against held-out data, the most probable first.

    Args:
        bench: fits.
        found: hypotheses, fitted to the training data.
        held_out: recordings that nothing was fitted to.
    """
    counted = sum(experiment.counted for experiment in held_out)
    first = _looked_at(bench, list(found.hypotheses.values()), held_out)
    chosen = _contenders(first, found)
    finer = FINER * bench.fine
    refitted = bench.side_by_side(
        lambda h: bench.refit(h, finer, FINISH) if _decides(h, found) else h,
        chosen,
    )
    # farther from the noise, what no model explains outweighs what is left to gain
    if min(h.fit.over_noise for h in refitted) < NEAR:
        refitted = _finished(bench, refitted)
    latest = {h.ids: h for h in refitted}
    # the finer step may have led one of two nested models to another place
    latest |= {h.ids: h for h in slightly_worse(bench, refitted, latest, slight=0.0)}

    def weighed(fits: Sequence[Hypothesis]) -> list[Judged]:
        paying = [h for h in fits if pays(h, fits) and all(c.says_something(h.values) for c in h.effects)]
        judged = bench.side_by_side(lambda h: _predicted(bench, h, held_out, counted, finer), paying)
        return with_probabilities([j for j in judged if predicts(j, judged)])

    judged = weighed(list(latest.values()))
    if _may_lie_elsewhere(judged[0]):
        lower = _in_their_valleys(bench, list(latest.values()))
        if lower:
            judged = weighed(list((latest | lower).values()))
    return judged


def judge_as_fitted(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """The same in haste, after an interrupt: one rollout each, and what is uncertain of the parameters counts as error.

    Args:
        bench: rollouts.
        hypotheses: as they were fitted when the search ended.
        held_out: recordings that nothing was fitted to.
    """
    return with_probabilities(_looked_at(bench, hypotheses, held_out))


def _may_lie_elsewhere(best: Judged) -> bool:
    """Whether the best model is near the noise where it was fitted, and leaves more of what it was not fitted to."""
    return best.hypothesis.fit.over_noise < NEAR and best.over_noise > ABOVE_NOISE


def _in_their_valleys(bench: Workbench, hypotheses: Sequence[Hypothesis]) -> dict[frozenset[str], Hypothesis]:
    """Those near the best that lie lower elsewhere in the valleys that the data leave (`valleys.along_valleys`)."""
    least = min(cost_of(h) for h in hypotheses)
    near = [h for h in hypotheses if cost_of(h) < least + NEAR_BEST]
    gone = bench.side_by_side(bench.along_valleys, near)
    return {h.ids: h for h, before in zip(gone, near, strict=True) if h.fit is not before.fit}


def _finished(bench: Workbench, hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The same, with those near the best fitted on until they end: where two differ by little, the way left decides."""
    latest = {h.ids: h for h in hypotheses}
    fallen = dict.fromkeys(latest, math.inf)
    for _ in range(FURTHER):
        least = min(cost_of(h) for h in latest.values())
        rivals = [h for h in latest.values() if cost_of(h) < least + NEAR_BEST]
        near = [h for h in rivals if fallen[h.ids] > UNFINISHED]
        if not near or len(rivals) < 2:
            break
        for h in bench.side_by_side(lambda h: bench.refit(h, h.step, FINISH), near):
            fallen[h.ids] = latest[h.ids].fit.objective - h.fit.objective
            latest[h.ids] = h
    return list(latest.values())


def _predicted(
    bench: Workbench, hypothesis: Hypothesis, held_out: Sequence[Experiment], counted: int, step: float
) -> Judged:
    """A hypothesis with the likelihood of the held-out data."""
    problem = bench.problem(hypothesis.effects, step, held_out)
    unit = hypothesis.fit.unit
    residuals = problem.residuals(unit)
    plain = Judged(hypothesis, residuals, counted)
    far_off = plain.over_noise > SMALL
    if far_off and hypothesis.fit.over_noise > AT_NOISE:
        return plain
    jacobian = problem.jacobian(unit, residuals, bench.movable(hypothesis.effects, problem.parameters))
    bench.evaluations += problem.evaluations
    chi_squared, spread = predictive(residuals, jacobian, hypothesis.fit)
    if far_off or 2.0 * plain.half_chi_squared - chi_squared > NEARBY:
        both = bench.fit(
            hypothesis.effects,
            hypothesis.values,
            step,
            POLISH if far_off else FINISH,
            tolerance=1e-4,
            experiments=[*bench.training, *held_out],
        )
        chi_squared = max(both.fit.objective - hypothesis.fit.objective, 0.0)
    return replace(plain, chi_squared=chi_squared, spread=spread)


def predictive(residuals: np.ndarray, jacobian: np.ndarray, fit: Fit) -> tuple[float, float]:
    """Squared residuals r' (I + J S J')^-1 r and spread log det (I + J S J') of held-out data.

    Args:
        residuals: r. # (values,)
        jacobian: J. # (values, n)
        fit: to the training data; S is the inverse of its information, with a range's variance for a parameter of
            which nothing else is known.
    """
    known = fit.jacobian.T @ fit.jacobian + fit.prior_jacobian.T @ fit.prior_jacobian
    free = np.diag(fit.prior_jacobian) == 0.0
    known[free, free] += 1.0 / SPREAD**2
    both = known + jacobian.T @ jacobian
    pulled = jacobian.T @ residuals
    chi_squared = float(residuals @ residuals - pulled @ np.linalg.solve(both, pulled))
    spread = float(np.linalg.slogdet(both)[1] - np.linalg.slogdet(known)[1])
    return chi_squared, spread


def pays(hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether every further effect also lowers the error of the training data by what chance could not.

    The same is asked of an effect in place of its special case. Two fits of nearly the same model end in slightly
    different places; on held-out data that can look like the gain of an effect that does next to nothing.
    """
    return all(
        other.fit.objective - hypothesis.fit.objective >= _to_pay(hypothesis, other) for other in others
    )


def predicts(judged: Judged, others: Sequence[Judged]) -> bool:
    """Whether a hypothesis predicts the held-out data better than everything that it contains.

    What lowers the error of the training data alone stands for something else there, such as an error of the step.
    """
    return all(
        other.ahead > judged.ahead
        for other in others
        if _to_pay(judged.hypothesis, other.hypothesis) > -math.inf
    )


def _to_pay(hypothesis: Hypothesis, other: Hypothesis) -> float:
    """Fall of the squared residuals that a hypothesis owes to another one that it contains; else minus infinity."""
    own = [c for c in hypothesis.effects if c.size_path not in other.ids]
    special = [c for c in other.effects if c.size_path not in hypothesis.ids]
    if own and not special:
        return gain_needed(other.fit) * len(own)
    contained = [any(s.is_special_case_of(c) for c in own) for s in special]
    return GAIN_NEEDED * len(own) if special and all(contained) and len(own) == len(special) else -math.inf


def _looked_at(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """What hypotheses leave of the held-out data as they are fitted."""
    counted = sum(experiment.counted for experiment in held_out)
    return bench.side_by_side(
        lambda h: Judged(h, bench.residuals(h, held_out, bench.fine), counted), hypotheses
    )


def judge_given_up(bench: Workbench, found: Search, held_out: Sequence[Experiment]) -> list[Judged]:
    """What the held-out data say of hypotheses that were not fitted to the end, the best first."""
    left = [h for key, h in found.given_up.items() if key not in found.hypotheses]
    return sorted(_looked_at(bench, left, held_out), key=lambda j: j.half_chi_squared)


def _decides(hypothesis: Hypothesis, found: Search) -> bool:
    """Whether the error of the step could matter: only for those near the best, and if that is near the noise.

    Where a law explains what none of them does, it does not.
    """
    best = found.best.fit
    return found.law is None and best.over_noise < NEARLY and hypothesis.fit.objective < 2.0 * best.objective


def _contenders(first: Sequence[Judged], found: Search) -> list[Hypothesis]:
    """Those that may still win, and always the nominal model and the best fits without one of their effects."""
    ranked = sorted(first, key=lambda j: -j.support)
    best = ranked[0]
    scale = dispersion(best)
    near = [
        j.hypothesis for j in ranked if (j.half_chi_squared - best.half_chi_squared) / scale < OUT_OF_REACH
    ]
    lesser = [
        h
        for h in found.hypotheses.values()
        if h.ids < best.hypothesis.ids and len(h.ids) == len(best.hypothesis.ids) - 1
    ]
    chosen = [best.hypothesis, found.baseline, found.best, *lesser, *near]
    unique = {h.ids: h for h in chosen}
    return list(unique.values())[:CONTENDERS]
