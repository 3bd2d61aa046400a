"""Models with one effect more: which are tried, from where, and how far each is followed."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.candidates import Candidate, one_contains_the_other, redundant
from hydrolek_drake.diagnosis.effort import (
    AT_NOISE,
    BEAM,
    COARSE,
    FAR,
    GLANCE,
    HOPELESS,
    LOOK,
    MOST_EFFECTS,
    NEAR,
    NEARLY,
    POLISH,
)
from hydrolek_drake.diagnosis.first_fits import Trial, anew, anew_pulled, glance, own_values
from hydrolek_drake.diagnosis.gains import PROMISING, gain_needed
from hydrolek_drake.diagnosis.moments import timed
from hydrolek_drake.diagnosis.score import Score, gain_of_pair, scores_of
from hydrolek_drake.diagnosis.unsticking import unstuck
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of

UNDECIDED = 2.0
"""First fits whose squared residuals are within this factor of the best one's are not told apart by so short a part."""

LIKELY = 4
"""So many moments are fitted from, of those at which an effect may begin."""

FOLLOWED = 5
"""So many of the first fits are followed up."""

MOST_UNDECIDED = 15
"""At most so many of them go on with the whole recording."""


@dataclass(frozen=True)
class Grown:
    """Models with one effect more.

    Attributes:
        hypotheses: fitted to the end, the best first.
        given_up: sets of effects with which no more than a few steps were taken, or that fell behind.
    """

    hypotheses: list[Hypothesis]
    given_up: dict[frozenset[str], Hypothesis]


def grow(
    bench: Workbench,
    beam: Sequence[Hypothesis],
    candidates: Sequence[Candidate],
    of_nominal: Sequence[Score],
    over: float,
) -> Grown:
    """Every hypothesis of the beam with one effect more.

    Args:
        bench: data, rig and fits.
        beam: hypotheses that are extended.
        candidates: every effect that may be added.
        of_nominal: scores of the effects against the fitted nominal model.
        over: what the best model so far leaves, over the noise.
    """
    far = over > FAR
    step = bench.coarsest(beam[0], over, COARSE if far else 2.0 if over > NEAR else 1.0)
    trials: dict[frozenset[str], Trial] = {}
    every: dict[frozenset[str], Trial] = {}
    pairs: list[Trial] = []
    for parent in beam:
        scored: Sequence[Score]
        if parent.effects or far:
            scored = scores_of(bench, bench.refit(parent, step, 1) if far else parent, candidates, step)
        else:
            scored = of_nominal
        _add(trials, bench, parent, scored, all_of_them=far)
        if AT_NOISE < over < NEAR:
            pairs += _pairs(parent, scored)
            _add(every, bench, parent, scored, all_of_them=True)
    if not trials and not every:
        return Grown([], {})
    if over < NEAR:
        return Grown(_near(bench, beam[0], list(trials.values()), pairs, list(every.values()), step), {})
    return _from_afar(bench, list(trials.values()), step)


def _add(
    trials: dict[frozenset[str], Trial],
    bench: Workbench,
    parent: Hypothesis,
    scored: Sequence[Score],
    *,
    all_of_them: bool,
) -> None:
    """Add what may be tried beside a model to what is tried already: what promises something, or everything."""
    promising = PROMISING * gain_needed(parent.fit)
    for score in scored:
        if redundant(parent.effects, score.candidate):
            continue
        if not (all_of_them or score.candidate.effect.sudden) and score.gain < promising:
            continue
        effects = (*parent.effects, score.candidate)
        trial = trials.setdefault(key_of(effects), Trial(effects))
        trial.gain = max(trial.gain, score.gain)
        start = {**parent.values, **score.start}
        trial.may_begin(start, score.left)
        for moment in score.moments[:LIKELY]:
            trial.may_begin({**start, **moment})
        if all_of_them and not parent.effects:
            # the parent's values may have gone far astray to make up for what is missing
            trial.may_begin(own_values(bench, effects, start))


def _from_afar(bench: Workbench, trials: Sequence[Trial], step: float) -> Grown:
    """First fits of all to a part of the recording; the best are followed to the end.

    Args:
        bench: data and fits.
        trials: what is tried.
        step: integration step of all but the last fits [s].
    """
    glances = _in_order(bench.side_by_side(lambda trial: glance(bench, trial, step), trials))
    bound = UNDECIDED * glances[0].fit.objective
    undecided = [h for h in glances if h.fit.objective < bound][:MOST_UNDECIDED]
    if len(undecided) > FOLLOWED:
        whole = bench.side_by_side(
            lambda h: bench.refit(h, h.step, GLANCE, tolerance=1e-3, alone=True), undecided
        )
        glances = [*_in_order(whole), *glances[len(undecided) :]]
    behind = {h.ids: h for h in glances}
    bound = HOPELESS * glances[0].fit.objective
    followed = [h for h in glances if h.fit.objective < bound][:FOLLOWED]
    looks = _in_order(
        bench.side_by_side(lambda h: bench.refit(h, h.step, LOOK, tolerance=1e-4, alone=True), followed)
    )
    alike = UNDECIDED * looks[0].fit.objective
    looks = _in_order([timed(bench, h, h.step) if h.fit.objective < alike else h for h in looks])
    if looks[0].fit.over_noise > NEARLY:
        looks = unstuck(bench, glances, looks)
    behind |= {h.ids: h for h in looks}
    nearest = looks[0].fit.over_noise
    near = [h for h in looks if h.fit.over_noise < max(1.5 * nearest, AT_NOISE)][:BEAM]
    polished = bench.side_by_side(lambda h: bench.refit(h, bench.fine, POLISH), near)
    polished = _in_order(
        [timed(bench, h, bench.fine) if h.fit.over_noise > AT_NOISE else h for h in polished]
    )
    return Grown([*polished, *looks[len(near) :]][: max(len(polished), 3)], behind)


def _in_order(hypotheses: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The best first."""
    return sorted(hypotheses, key=lambda h: h.fit.objective)


def _near(
    bench: Workbench,
    parent: Hypothesis,
    trials: Sequence[Trial],
    pairs: Sequence[Trial],
    every: Sequence[Trial],
    step: float,
) -> list[Hypothesis]:
    """Fits beside a model that is right but for something small: Gauss-Newton steps from it go straight there.

    Where they do not reach the noise, it has bent its parameters: everything is fitted anew from the rig's own, with
    pulled rollouts, after which the best of these go on; where that does not reach it either, what promises most, and
    what is sudden, also with free ones. What joints that move together do to each other was told beside the model
    without the effect, so that the right one may not reach the noise yet: what brings enough is weighed anew first.

    Args:
        bench: data and fits.
        parent: the model that is near the noise.
        trials: what is tried.
        pairs: the same of two effects more; none where the model is at the noise.
        every: everything that can be tried, whether it promises something or not; nothing where the model is at the
            noise.
        step: integration step [s].
    """
    by_left = sorted(trials, key=lambda trial: min(trial.left))[:FOLLOWED]
    by_gain = sorted(trials, key=lambda trial: -trial.gain)[:FOLLOWED]  # sizes tried may all be too large
    others = [trial for trial in by_gain if trial not in by_left]
    fits = bench.side_by_side(
        lambda trial: bench.fit(trial.effects, trial.likeliest, step, POLISH),
        [*by_left, *others, *pairs],
    )
    if bench.together and any(_brings_enough(h, parent) for h in fits):
        every = []
    if every and all(h.fit.over_noise > AT_NOISE for h in fits):
        smooth = [trial for trial in every if not trial.effects[-1].effect.sudden]
        pulled = _in_order(bench.side_by_side(lambda trial: anew_pulled(bench, trial, step), smooth))
        fits += bench.side_by_side(lambda h: bench.refit(h, step, LOOK, alone=True), pulled[:FOLLOWED])
    if every and all(h.fit.over_noise > AT_NOISE for h in fits):
        again = [trial for trial in trials if trial in by_gain or trial.effects[-1].effect.sudden]
        fits += bench.side_by_side(lambda trial: anew(bench, trial, step), again)
    fits = _in_order(fits)
    return _in_order([timed(bench, fits[0], step), *fits[1:]])


def _brings_enough(hypothesis: Hypothesis, parent: Hypothesis) -> bool:
    """Whether effects lower the squared residuals of a model by as much as one more must."""
    return parent.fit.objective - hypothesis.fit.objective > gain_needed(parent.fit)


def _pairs(parent: Hypothesis, scored: Sequence[Score]) -> list[Trial]:
    """Pairs of effects that together promise what neither does alone, the best first.

    Of two small effects each may hide behind a third one, which takes a part of both; taken one at a time, that one
    comes first and the others never.
    """
    if len(parent.effects) + 2 > MOST_EFFECTS:
        return []
    free = [s for s in scored if s.gain > 0.0 and not redundant(parent.effects, s.candidate)]
    alone = max((s.gain for s in free), default=0.0)
    trials = []
    for first, second in itertools.combinations(free, 2):
        candidates = (first.candidate, second.candidate)
        if one_contains_the_other(*candidates):
            continue
        gain = gain_of_pair(first, second)
        if gain - alone < gain_needed(parent.fit):
            continue
        trial = Trial((*parent.effects, *candidates), gain)
        trial.may_begin({**parent.values, **first.start, **second.start}, parent.fit.objective - gain)
        trials.append(trial)
    return sorted(trials, key=lambda trial: -trial.gain)[:FOLLOWED]
