"""The evidence for structures: the density of held-out data given the training data, parameters integrated out.

The training data leave a structure's parameters uncertain by a covariance S. To first order the held-out residuals r of
a structure that is right then have the covariance I + J S J', J their Jacobian, and their log-density is

    -1/2 r' (I + J S J')^-1 r - 1/2 log det (I + J S J')

(MacKay, Bayesian interpolation, Neural Computation 4, 1992). Where the parameters would have to move so far that the
first order may not hold, the structure is fitted to both data, and what both leave beyond what the training data leave
alone stands for the first term.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.evidence.fitted_to_both import beyond, fitted_to_both, to_both
from hydrolek_drake.diagnosis.evidence.judged import (
    Judged,
    blocks_of,
    difference,
    with_least,
    with_probabilities,
)
from hydrolek_drake.diagnosis.evidence.nuisance import own_of_recordings, with_stands
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.settings import EVIDENCE, GAINS, NOISE
from hydrolek_drake.diagnosis.structures.cost import cost, gain_needed
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.lost_windows import recording_of
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.least_squares.lockstep import with_slopes
from hydrolek_drake.identification.least_squares.place import Place


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


def judge_given_up(bench: Workbench, found: Tried, held_out: Sequence[Experiment]) -> list[Judged]:
    """What the held-out data say of hypotheses that were not fitted to the end, the best first."""
    left = [h for key, h in found.given_up.items() if key not in found.hypotheses]
    return sorted(_looked_at(bench, left, held_out), key=lambda j: j.half_chi_squared)


def _looked_at(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """What hypotheses leave of the held-out data as they are fitted."""
    counted = sum(experiment.counted for experiment in held_out)
    return bench.side_by_side(
        lambda h: with_least(
            Judged(h, bench.residuals(h, held_out, bench.step_for(h.effects)), counted),
            bench.training,
            held_out,
        ),
        hypotheses,
    )


def predictive(residuals: np.ndarray, jacobian: np.ndarray, fit: Fit) -> tuple[np.ndarray, float]:
    """What each value contributes to r' (I + J S J')^-1 r of held-out data, and the spread log det (I + J S J').

    Args:
        residuals: r. # (values,)
        jacobian: J. # (values, n)
        fit: to the training data; S is the inverse of its information, with a range's variance for a parameter of
            which nothing else is known.

    Returns:
        The contributions, some of which may be less than nothing, and the spread. # (values,)
    """
    known = fit.jacobian.T @ fit.jacobian + fit.prior_jacobian.T @ fit.prior_jacobian
    free = np.diag(fit.prior_jacobian) == 0.0
    known[free, free] += 1.0 / SPREAD**2
    both = known + jacobian.T @ jacobian
    pulled = jacobian.T @ residuals
    shares = residuals * (residuals - jacobian @ np.linalg.solve(both, pulled))
    spread = float(np.linalg.slogdet(both)[1] - np.linalg.slogdet(known)[1])
    return shares, spread


def pays(hypothesis: Hypothesis, others: Sequence[Hypothesis]) -> bool:
    """Whether every further effect also lowers the error of the training data by what chance could not.

    The same is asked of an effect in place of its special case. Two fits of nearly the same model end in slightly
    different places; on held-out data that can look like the gain of an effect that does next to nothing.
    """
    return all(
        other.fit.objective - hypothesis.fit.objective >= _to_pay(hypothesis, other) for other in others
    )


def predicts(judged: Judged, others: Sequence[Judged], blocks: np.ndarray) -> bool:
    """Whether the held-out data are denser given a hypothesis than given everything that it contains.

    What lowers the error of the training data alone stands for something else there, such as an error of the step. The
    simpler one is kept also where it is behind by less than a standard error of the difference over blocks (Breiman,
    Friedman, Olshen, Stone, Classification and regression trees, 1984, section 3.4.3): what soaks up what every model
    leaves out gains in some blocks and loses in others.

    Args:
        judged: the hypothesis.
        others: all that were judged.
        blocks: of the data by which they were, see `judged.blocks_of`. # (values,)
    """
    return all(
        judged.log_density - other.log_density > difference(judged, other, blocks)[1]
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
    return GAINS.needed * len(own) if special and all(contained) and len(own) == len(special) else -math.inf


def judge_structures(bench: Workbench, found: Tried, held_out: Sequence[Experiment]) -> list[Judged]:
    """Structures that may be right, the most probable first.

    Args:
        bench: data and problems.
        found: structures, fitted to the training data.
        held_out: data that nothing was fitted to.
    """
    last = bench.settings.last
    refined: list[Hypothesis] = []
    contenders = _contenders(found)
    for rounds, some in ((last.rounds, _in_doubt(contenders, found.best)), (0, contenders)):
        entrants = [Entrant(h.effects, h.values) for h in some if h.ids not in {r.ids for r in refined}]
        if entrants:
            refined += race(bench, entrants, (replace(last, rounds=rounds, keep=len(entrants)),))
    refined = [h for h in refined if pays(h, refined) and all(c.says_something(h.values) for c in h.effects)]
    judged = _predicted(bench, refined, held_out)
    blocks = blocks_of(held_out)
    kept = [with_least(j, bench.training, held_out) for j in judged if predicts(j, judged, blocks)]
    return with_probabilities(kept)


def _contenders(found: Tried) -> list[Hypothesis]:
    """Those that may still be right, always with the nominal model and the best one less one addition."""
    best = found.best
    ranked = sorted(found.hypotheses.values(), key=cost)
    near = _in_doubt(ranked, best)
    lesser = [h for h in ranked if h.ids < best.ids and len(h.ids) == len(best.ids) - 1]
    unique = {h.ids: h for h in (best, found.baseline, *lesser, *near)}
    return list(unique.values())[: EVIDENCE.most_judged]


def _in_doubt(hypotheses: Sequence[Hypothesis], best: Hypothesis) -> list[Hypothesis]:
    """Those that the training data leave in doubt beside the best one."""
    doubt = max(EVIDENCE.out_of_reach, EVIDENCE.doubt * best.fit.objective)
    return [h for h in hypotheses if 0.5 * (cost(h) - cost(best)) < doubt]


def _predicted(
    bench: Workbench, hypotheses: Sequence[Hypothesis], held_out: Sequence[Experiment]
) -> list[Judged]:
    """Structures with the density of the held-out data."""
    counted = sum(experiment.counted for experiment in held_out)
    begun = [with_stands(bench, Judged(h, np.zeros(0), counted), held_out) for h in hypotheses]
    places = []
    for own in begun:
        for experiment in held_out:
            effects, unit = own.stands[recording_of(experiment)]
            problem = problem_with(
                bench, effects, bench.step_for(effects, bench.settings.last.coarse), [experiment]
            )
            places.append(Place(problem, bench.movable(effects, problem.parameters), unit, exact=True))
    told = iter(with_slopes(places, bench.pool, bench.cores))
    judged, far, both = [], [], []
    doubtful = _in_doubt(hypotheses, min(hypotheses, key=cost))
    for own in begun:
        h = own.hypothesis
        some = [next(told) for _ in held_out]
        residuals = np.concatenate([place.residuals for place in some])
        slopes = np.concatenate([_of_the_machine(place, h) for place in some])
        shares, spread = predictive(residuals, slopes, h.fit)
        chi_squared = float(shares.sum())
        one = replace(own, held_out=residuals, chi_squared=chi_squared, shares=shares, spread=spread)
        is_far = one.over_noise > NOISE.far or float(residuals @ residuals) - chi_squared > EVIDENCE.nearby
        far.append(is_far and any(h is d for d in doubtful) and not own_of_recordings(h).any())
        judged.append(one)
        both.append((residuals, slopes))
    # the only one in doubt, and denser than all others, would be more so
    decided = len(doubtful) == 1 and max(judged, key=lambda j: j.log_density).hypothesis is doubtful[0]
    chosen = [] if decided else [i for i, is_far in enumerate(far) if is_far]
    fits = {
        i: replace(
            to_both(bench, judged[i].hypothesis, held_out),
            residuals=np.concatenate([judged[i].hypothesis.fit.residuals, both[i][0]]),
            slopes=np.concatenate([judged[i].hypothesis.fit.jacobian, both[i][1]]),
        )
        for i in chosen
    }
    for renewing in (False, True):
        ended = fitted_to_both(bench, list(fits.values()), renewing=renewing)
        fits = dict(zip(fits, ended, strict=True))
        for i, place in fits.items():
            judged[i] = replace(judged[i], chi_squared=beyond(place, judged[i].hypothesis))
        # slopes of where the fits began tell well enough who is beyond doubt
        least = max((j.log_density for j in judged), default=0.0) - EVIDENCE.out_of_reach
        near = [i for i, j in enumerate(judged) if j.log_density > least]
        fits = {i: place for i, place in fits.items() if i in near} if len(near) > 1 else {}
    return judged


def _of_the_machine(place: Place, hypothesis: Hypothesis) -> np.ndarray:
    """Slopes of held-out residuals; zero for parameters that were fitted to each recording. # (values, n)."""
    assert place.slopes is not None
    columns = {path: i for i, path in enumerate(place.problem.parameters.paths)}
    own = own_of_recordings(hypothesis)
    slopes = np.zeros((len(place.slopes), own.size))
    for i, path in enumerate(hypothesis.values):
        if not own[i]:
            slopes[:, i] = place.slopes[:, columns[path]]
    return slopes
