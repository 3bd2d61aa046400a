"""Models with one effect more: which are tried, from where, and how far each is followed."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.score import Score, gain_of_pair, scores_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import PULLED_STEPS, PULLED_TOLERANCE, Fit
from hydrolek_drake.identification.problem import PULL_S

COARSE = 4.0
"""Integration step of the first fits over the rig's own: 16 times its error, a quarter of its time."""

FAR, NEAR = 3.0, 1.3
"""A model this many times above the noise is searched with the coarse step, or with twice the rig's own: the
error of the step must stay far below what is to be explained."""

GLANCE_S = 20.0
"""First fits see so many seconds of a recording: errors that grow with time are smaller, and so is the work."""

UNDECIDED = 2.0
"""First fits whose squared residuals are within this factor of the best one's are not told apart by so short a part."""

GAIN_NEEDED = 12.0
"""Smallest gain (fall of the squared residuals) that is followed up: 3.5 standard deviations of one size."""

FIDELITY = 0.004
"""Fall of the squared residuals, as a share of the values, below which an effect is not told from what every
model leaves out: 0.2 % of the noise's rms."""

AT_NOISE = 1.03
"""A model within 3 % of the noise: the estimate of the noise itself is good to 1 to 2 %."""

MOST_EFFECTS = 3
"""At most so many effects are searched together."""

NEARLY = 1.5
"""A third effect is looked for only if two leave at most this many times the noise: it would be a small one."""

BEAM = 3
"""So many hypotheses are extended by a further effect, and only the best once it is near the noise."""

GLANCE, LOOK, POLISH = 4, 15, 8
"""Trust-region steps of a first fit, of one that is followed up, and of one with the rig's own step."""

FOLLOWED = 5
"""So many of the first fits are followed up."""

MOST_UNDECIDED = 15
"""At most so many of them go on with the whole recording."""

TRIED_PULLED = 12
"""So many of the first fits are tried with pulled rollouts too."""

HOPELESS = 4.0
"""First fits whose squared residuals are so many times the best one's are not followed up."""


def gain_needed(fit: Fit) -> float:
    """Fall of the squared residuals that one more effect must bring."""
    return max(GAIN_NEEDED, FIDELITY * fit.counted)


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
    step = bench.fine * (COARSE if far else 2.0 if over > NEAR else 1.0)
    work: dict[frozenset[str], _Start] = {}
    scored_by: dict[frozenset[str], Sequence[Score]] = {}
    for parent in beam:
        scored = (
            of_nominal
            if not parent.effects and not far
            else scores_of(bench, bench.refit(parent, step, 1) if far else parent, candidates, step)
        )
        scored_by[parent.ids] = scored
        for score in scored:
            if _redundant(parent, score.candidate) or (
                not far and score.gain < 0.5 * gain_needed(parent.fit)
            ):
                continue
            effects = (*parent.effects, score.candidate)
            starts = work.setdefault(key_of(effects), (effects, []))[1]
            starts.append((score.left, {**parent.values, **score.start}))
            if (
                far and not parent.effects
            ):  # the parent's values may have gone far astray to make up for what is missing
                joints = bench.joints_of(effects)
                kept = {k: v for k, v in parent.values.items() if _of_another_joint(k, joints)}
                starts.append((math.inf, {**kept, **score.start}))
    if not work:
        return Grown([], {})
    if (
        over < NEAR
    ):  # the parent is right but for something small: Gauss-Newton steps from it go straight there
        items = sorted(work.values(), key=lambda item: min(left for left, _ in item[1]))[:FOLLOWED]
        if over > AT_NOISE:
            items += [pair for parent in beam for pair in _pairs(parent, scored_by[parent.ids])]
        fits = bench.side_by_side(lambda i: bench.fit(i[0], min(i[1], key=_first)[1], step, POLISH), items)
        return Grown(sorted(fits, key=lambda h: h.fit.objective), {})
    glances = bench.side_by_side(
        lambda item: _glance(bench, item[0], [start for _, start in item[1]], step), list(work.values())
    )
    glances.sort(key=lambda h: h.fit.objective)
    undecided = [h for h in glances if h.fit.objective < UNDECIDED * glances[0].fit.objective][
        :MOST_UNDECIDED
    ]
    if len(undecided) > FOLLOWED:
        whole = bench.side_by_side(
            lambda h: bench.refit(h, step, GLANCE, tolerance=1e-3, alone=True), undecided
        )
        glances = [*sorted(whole, key=lambda h: h.fit.objective), *glances[len(undecided) :]]
    behind = {h.ids: h for h in glances}
    bound = HOPELESS * glances[0].fit.objective
    followed = [h for h in glances if h.fit.objective < bound][:FOLLOWED]
    looks = bench.side_by_side(lambda h: bench.refit(h, step, LOOK, tolerance=1e-4, alone=True), followed)
    looks.sort(key=lambda h: h.fit.objective)
    if looks[0].fit.over_noise > NEARLY:
        looks = unstuck(bench, glances[:TRIED_PULLED], looks, step)
    behind |= {h.ids: h for h in looks}
    nearest = looks[0].fit.over_noise
    near = [h for h in looks if h.fit.over_noise < max(1.5 * nearest, AT_NOISE)][:BEAM]
    polished = bench.side_by_side(lambda h: bench.refit(h, bench.fine, POLISH), near)
    polished.sort(key=lambda h: h.fit.objective)
    return Grown([*polished, *looks[len(near) :]][: max(len(polished), 3)], behind)


def _pairs(parent: Hypothesis, scored: Sequence[Score]) -> list[_Start]:
    """Pairs of effects that together promise what neither does alone, the best first.

    Of two small effects each may hide behind a third one, which takes a part of both; taken one at a time, that one
    comes first and the others never.
    """
    if len(parent.effects) + 2 > MOST_EFFECTS:
        return []
    free = [s for s in scored if s.gain > 0.0 and not _redundant(parent, s.candidate)]
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


def unstuck(
    bench: Workbench, glances: Sequence[Hypothesis], looks: Sequence[Hypothesis], step: float
) -> list[Hypothesis]:
    """Fits that got stuck, begun again where rollouts that are pulled to the measurements fit best.

    The residuals of a free rollout pile up what went wrong before: a joint that sticks at the wrong moment is
    wrong from then on, and least squares ends in the next hollow. Pulled rollouts forget within `PULL_S`, as the
    prediction errors of an observer do (Ljung, System Identification, 1999, chapter 7), so that the same fit goes
    its way from far off; what drifts slowly they do not see, and so the free fits stand beside them.
    """
    part = [experiment.until(GLANCE_S) for experiment in bench.training]

    def pulled(glance: Hypothesis) -> Hypothesis:
        joints = bench.joints_of(glance.effects)
        others = {k: v for k, v in glance.values.items() if _of_another_joint(k, joints)}
        starts = [{**others, **start} for start in ({}, *_starts_of(glance.effects))]
        return fit_pulled(bench, glance.effects, starts, step, part)

    ahead = sorted(bench.side_by_side(pulled, glances), key=lambda h: h.fit.objective)

    def followed(glance: Hypothesis) -> Hypothesis:
        near = bench.fit(
            glance.effects, glance.values, step, LOOK, tolerance=1e-4, pull_time=PULL_S, alone=True
        )
        return bench.refit(near, step, LOOK, tolerance=1e-4, alone=True)

    again = bench.side_by_side(followed, ahead[:BEAM])
    best = {h.ids: h for h in sorted([*looks, *again], key=lambda h: -h.fit.objective)}
    return sorted(best.values(), key=lambda h: h.fit.objective)


def fit_pulled(
    bench: Workbench,
    effects: Sequence[Candidate],
    starts: Sequence[dict[str, float]],
    step: float,
    experiments: Sequence[Experiment],
) -> Hypothesis:
    """A fit with pulled rollouts, from the start at which they fit best."""
    problem = bench.problem(effects, step, experiments, PULL_S)
    units = [problem.parameters.unit(start) for start in starts]
    errors = [float(np.sum(problem.residuals(unit) ** 2)) for unit in units]
    return bench.fit(
        effects,
        starts[int(np.argmin(errors))],
        step,
        PULLED_STEPS,
        tolerance=PULLED_TOLERANCE,
        experiments=experiments,
        pull_time=PULL_S,
        alone=True,
    )


def _starts_of(effects: Sequence[Candidate]) -> list[dict[str, float]]:
    """Every combination of the places where searches of these effects begin."""
    combinations = itertools.product(*(candidate.starts for candidate in effects))
    return [{path: value for start in chosen for path, value in start.items()} for chosen in combinations]


def _first(start: tuple[float, dict[str, float]]) -> float:
    return start[0]


def _glance(
    bench: Workbench, effects: Sequence[Candidate], starts: Sequence[dict[str, float]], step: float
) -> Hypothesis:
    """A few steps from each start."""
    part = [experiment.until(GLANCE_S) for experiment in bench.training]
    fits = [
        bench.fit(effects, start, step, GLANCE, tolerance=1e-3, experiments=part, alone=True)
        for start in different(starts)[:2]
    ]
    return min(fits, key=lambda h: h.fit.objective)


def _of_another_joint(path: str, joints: set[str]) -> bool:
    """Whether a parameter belongs to a joint, and to none of these."""
    return path.startswith("joints.") and path.split(".")[1] not in joints


def different(starts: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    """Starts, each once."""
    kept: list[dict[str, float]] = []
    for start in starts:
        if not any(start == other for other in kept):
            kept.append(start)
    return kept


def _redundant(parent: Hypothesis, candidate: Candidate) -> bool:
    """Whether both together say nothing new: the effect, and one that the hypothesis has."""
    return any(_contains(c, candidate) for c in parent.effects)


def _contains(first: Candidate, second: Candidate) -> bool:
    """Whether one of two effects at the same joint contains the other."""
    own = first.joint == second.joint
    return own and (second.id in first.effect.contains or first.id in second.effect.contains)
