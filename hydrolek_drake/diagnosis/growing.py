"""Models with one effect more: which are tried, from where, and how far each is followed."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import (
    AT_NOISE,
    BEAM,
    COARSE,
    FAR,
    GLANCE,
    GLANCE_S,
    LOOK,
    NEAR,
    NEARLY,
    POLISH,
)
from hydrolek_drake.diagnosis.moments import begun, timed
from hydrolek_drake.diagnosis.score import Score, gain_of_pair, scores_of
from hydrolek_drake.diagnosis.unsticking import LED_STEP, different, of_another_joint, unstuck
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of
from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.problem import DIVERGED

UNDECIDED = 2.0
"""First fits whose squared residuals are within this factor of the best one's are not told apart by so short a part."""

GAIN_NEEDED = 12.0
"""Smallest gain (fall of the squared residuals) that is followed up: 3.5 standard deviations of one size."""

FIDELITY = 0.004
"""Fall of the squared residuals, as a share of the values, below which an effect is not told from what every
model leaves out: 0.2 % of the noise's rms."""

LIKELY = 4
"""So many moments are fitted from, of those at which an effect may begin."""

MOST_EFFECTS = 3
"""At most so many effects are searched together."""

FOLLOWED = 5
"""So many of the first fits are followed up."""

MOST_UNDECIDED = 15
"""At most so many of them go on with the whole recording."""

HOPELESS = 4.0
"""First fits whose squared residuals are so many times the best one's are not followed up."""


def gain_needed(fit: Fit) -> float:
    """Fall of the squared residuals that one more effect must bring.

    It is more than chance would bring, and more than what is known but roughly may leave.
    """
    return max(GAIN_NEEDED, FIDELITY * fit.counted, fit.unsure)


_Start = tuple[tuple[Candidate, ...], list[tuple[float, dict[str, float]]]]
"""Effects, and where their fit may begin: squared residuals that are promised, and values."""


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
    work: dict[frozenset[str], _Start] = {}
    scored_by: dict[frozenset[str], Sequence[Score]] = {}
    promised: dict[frozenset[str], float] = {}
    for parent in beam:
        scored = (
            of_nominal
            if not parent.effects and not far
            else scores_of(bench, bench.refit(parent, step, 1) if far else parent, candidates, step)
        )
        scored_by[parent.ids] = scored
        for score in scored:
            if redundant(parent.effects, score.candidate):
                continue
            if not (far or score.candidate.effect.sudden) and score.gain < 0.5 * gain_needed(parent.fit):
                continue
            effects = (*parent.effects, score.candidate)
            key = key_of(effects)
            starts = work.setdefault(key, (effects, []))[1]
            promised[key] = max(score.gain, promised.get(key, 0.0))
            start = {**parent.values, **score.start}
            starts.append((score.left, start))
            starts += [(math.inf, {**start, **moment}) for moment in score.moments[:LIKELY]]
            if (
                far and not parent.effects
            ):  # the parent's values may have gone far astray to make up for what is missing
                starts.append((math.inf, _own(bench, effects, start)))
    if not work:
        return Grown([], {})
    if over < NEAR:
        pairs = [pair for parent in beam for pair in _pairs(parent, scored_by[parent.ids])]
        return Grown(_near(bench, work, promised, pairs if over > AT_NOISE else None, step), {})
    glances = bench.side_by_side(
        lambda item: _glance(bench, item[0], [start for _, start in item[1]], step), list(work.values())
    )
    glances.sort(key=lambda h: h.fit.objective)
    undecided = [h for h in glances if h.fit.objective < UNDECIDED * glances[0].fit.objective][
        :MOST_UNDECIDED
    ]
    if len(undecided) > FOLLOWED:
        whole = bench.side_by_side(
            lambda h: bench.refit(h, h.step, GLANCE, tolerance=1e-3, alone=True), undecided
        )
        glances = [*sorted(whole, key=lambda h: h.fit.objective), *glances[len(undecided) :]]
    behind = {h.ids: h for h in glances}
    bound = HOPELESS * glances[0].fit.objective
    followed = [h for h in glances if h.fit.objective < bound][:FOLLOWED]
    looks = bench.side_by_side(lambda h: bench.refit(h, h.step, LOOK, tolerance=1e-4, alone=True), followed)
    looks.sort(key=lambda h: h.fit.objective)
    alike = UNDECIDED * looks[0].fit.objective
    looks = [timed(bench, h, h.step) if h.fit.objective < alike else h for h in looks]
    looks.sort(key=lambda h: h.fit.objective)
    if looks[0].fit.over_noise > NEARLY:
        looks = unstuck(bench, glances, looks)
    behind |= {h.ids: h for h in looks}
    nearest = looks[0].fit.over_noise
    near = [h for h in looks if h.fit.over_noise < max(1.5 * nearest, AT_NOISE)][:BEAM]
    polished = bench.side_by_side(lambda h: bench.refit(h, bench.fine, POLISH), near)
    polished = [timed(bench, h, bench.fine) if h.fit.over_noise > AT_NOISE else h for h in polished]
    polished.sort(key=lambda h: h.fit.objective)
    return Grown([*polished, *looks[len(near) :]][: max(len(polished), 3)], behind)


def _near(
    bench: Workbench,
    work: dict[frozenset[str], _Start],
    promised: dict[frozenset[str], float],
    pairs: Sequence[_Start] | None,
    step: float,
) -> list[Hypothesis]:
    """Fits beside a model that is right but for something small: Gauss-Newton steps from it go straight there.

    Where they do not reach the noise, it has bent its parameters, and what promises most is fitted anew from the rig's
    own.

    Args:
        bench: data and fits.
        work: effects, and where their fits may begin.
        promised: gain of each.
        pairs: the same of two effects more; None where the model is at the noise.
        step: integration step [s].
    """
    by_left = sorted(work, key=lambda key: min(left for left, _ in work[key][1]))[:FOLLOWED]
    by_gain = sorted(work, key=lambda key: -promised[key])[:FOLLOWED]  # sizes tried may all be too large
    items = [*(work[key] for key in dict.fromkeys([*by_left, *by_gain])), *(pairs or ())]
    fits = bench.side_by_side(lambda i: bench.fit(i[0], min(i[1], key=_first)[1], step, POLISH), items)
    if pairs is not None and min(h.fit.over_noise for h in fits) > AT_NOISE:
        again = [key for key in work if key in by_gain or work[key][0][-1].effect.sudden]
        fits += bench.side_by_side(lambda key: _anew(bench, work[key], step), again)
    fits.sort(key=lambda h: h.fit.objective)
    return sorted([timed(bench, fits[0], step), *fits[1:]], key=lambda h: h.fit.objective)


def _pairs(parent: Hypothesis, scored: Sequence[Score]) -> list[_Start]:
    """Pairs of effects that together promise what neither does alone, the best first.

    Of two small effects each may hide behind a third one, which takes a part of both; taken one at a time, that one
    comes first and the others never.
    """
    if len(parent.effects) + 2 > MOST_EFFECTS:
        return []
    free = [s for s in scored if s.gain > 0.0 and not redundant(parent.effects, s.candidate)]
    alone = max((s.gain for s in free), default=0.0)
    promised: list[tuple[float, _Start]] = []
    for first, second in itertools.combinations(free, 2):
        candidates = (first.candidate, second.candidate)
        if _contains(*candidates):
            continue
        gain = gain_of_pair(first, second)
        if gain - alone < gain_needed(parent.fit):
            continue
        start = {**parent.values, **first.start, **second.start}
        promised.append((gain, ((*parent.effects, *candidates), [(parent.fit.objective - gain, start)])))
    promised.sort(key=lambda item: -item[0])
    return [start for _, start in promised[:FOLLOWED]]


def _first(start: tuple[float, dict[str, float]]) -> float:
    return start[0]


def _glance(
    bench: Workbench, effects: Sequence[Candidate], starts: Sequence[dict[str, float]], step: float
) -> Hypothesis:
    """A few steps from each start."""
    if effects[-1].effect.sudden:
        return _sudden(bench, effects, starts[0], step)
    part = [experiment.until(GLANCE_S) for experiment in bench.training]
    near = begun(bench, effects, starts, step)
    moments = {free.path: near[free.path] for free in effects[-1].moments}
    others = different([{**start, **moments} for start in starts])[1:]
    fits = [
        bench.fit(effects, start, step, GLANCE, tolerance=1e-3, experiments=part, alone=True)
        for start in (near, *others[:1])
    ]
    best = min(fits, key=lambda h: h.fit.objective)
    if not diverged(best):
        return best
    # a start that promises most may be one that no rollout survives, such as a base that rocks faster than the step
    elsewhere = [{**near, **start} for start in effects[-1].starts]
    return min(
        [best, *(bench.fit(effects, start, step, GLANCE, 1e-3, part, alone=True) for start in elsewhere)],
        key=lambda h: h.fit.objective,
    )


def _anew(bench: Workbench, item: _Start, step: float) -> Hypothesis:
    """Effects fitted from the rig's own values of the joint, see `_own`."""
    effects, starts = item
    if effects[-1].effect.sudden:
        return bench.refit(_sudden(bench, effects, starts[0][1], step), step, LOOK)
    return bench.fit(effects, _own(bench, effects, min(starts, key=_first)[1]), step, LOOK)


def _sudden(
    bench: Workbench, effects: Sequence[Candidate], begin: dict[str, float], step: float
) -> Hypothesis:
    """First fits with a sudden effect: from where the model without it was fitted, and anew with each of its sizes.

    What it does is no small change of what the model does without it, so that there is no way downhill from there.
    """
    part = [experiment.until(GLANCE_S) for experiment in bench.training]
    own = _own(bench, effects, begin)
    starts = [begin, *({**own, **start} for start in effects[-1].starts)]
    finer = min(step, LED_STEP * bench.fine)  # a contact that opens is stiff
    fits = [bench.fit(effects, start, finer, LOOK, 1e-3, part, alone=True) for start in starts]
    return min(fits, key=lambda h: h.fit.objective)


def _own(bench: Workbench, effects: Sequence[Candidate], begin: dict[str, float]) -> dict[str, float]:
    """Where a fit begins anew: effects as given, the joint's own parameters as the rig has them.

    A model that lacks an effect has bent its parameters to make up for it.
    """
    joints = bench.joints_of(effects)
    return {k: v for k, v in begin.items() if ".effects." in k or of_another_joint(k, joints)}


def diverged(hypothesis: Hypothesis) -> bool:
    """Whether a rollout broke down."""
    return bool(np.max(np.abs(hypothesis.fit.residuals), initial=0.0) >= DIVERGED)


def redundant(effects: Sequence[Candidate], candidate: Candidate) -> bool:
    """Whether an effect says nothing new beside others, because one of them contains it or is contained in it."""
    return any(_contains(c, candidate) for c in effects)


def _contains(first: Candidate, second: Candidate) -> bool:
    """Whether one of two effects at the same joint contains the other."""
    return first.is_special_case_of(second) or second.is_special_case_of(first)
