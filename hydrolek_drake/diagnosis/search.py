"""The search for effects: add one at a time, several hypotheses abreast, and try to remove each again.

Everything here is fitted to the training data alone; which hypothesis is right is decided elsewhere, on data
that none of them was fitted to (`evidence`).
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.score import Score, gain_of_pair, scores_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of
from hydrolek_drake.identification.least_squares import Fit

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
"""A third effect is looked for only if two leave at most this many times the noise: it would be a small one ..."""

MATERIAL_GAIN = 0.3
"""... or if one promises to take this share of the squared residuals: far from the noise, as on real machines."""

BEAM = 3
"""So many hypotheses are extended by a further effect, and only the best once it is near the noise."""

GLANCE, LOOK, POLISH = 4, 15, 8
"""Trust-region steps of a first fit, of one that is followed up, and of one with the rig's own step."""

FOLLOWED = 5
"""So many of the first fits are followed up."""

MOST_UNDECIDED = 15
"""At most so many of them go on with the whole recording."""

FIRST_SHARE = 0.1
"""A first effect must take this share of the squared residuals of a nominal model that is far from the noise, or no
second one is looked for: of two effects, one alone takes much of what both do."""

PULL_S = 0.1
"""Time constant with which rollouts are pulled to what was measured when free ones get stuck: longer than a valve
takes to open and a chamber to fill, and far shorter than a move, over which errors pile up."""

PULLED_STEPS = 8
"""Trust-region steps of a fit with pulled rollouts."""

TRIED_PULLED = 12
"""So many of the first fits are tried with pulled rollouts too."""

HOPELESS = 4.0
"""First fits whose squared residuals are so many times the best one's are not followed up."""


@dataclass
class Search:
    """What was tried.

    Attributes:
        hypotheses: every set of effects that was fitted with the rig's own step, by its key.
        scores: of the effects against the fitted nominal model.
        left: gains of the effects that the best model has not.
        rounds: how many effects at once were searched.
        given_up: sets of effects that were too far behind after a few steps.
    """

    hypotheses: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    scores: list[Score] = field(default_factory=list)
    left: list[Score] = field(default_factory=list)
    rounds: int = 0
    given_up: dict[frozenset[str], Hypothesis] = field(default_factory=dict)

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of these effects."""
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis

    @property
    def baseline(self) -> Hypothesis:
        """The nominal model, fitted."""
        return self.hypotheses[frozenset()]

    @property
    def best(self) -> Hypothesis:
        """Best fit to the training data with each effect's parameters charged for."""
        return min(self.hypotheses.values(), key=cost_of)


def cost_of(hypothesis: Hypothesis) -> float:
    """Squared residuals plus what chance alone would gain by so many parameters, chosen among many."""
    gain = max(GAIN_NEEDED, FIDELITY * hypothesis.fit.counted)
    return hypothesis.fit.objective + gain * len(hypothesis.effects) + 2.0 * hypothesis.extra


def gain_needed(fit: Fit) -> float:
    """Fall of the squared residuals that one more effect must bring."""
    return max(GAIN_NEEDED, FIDELITY * fit.counted)


def search(
    bench: Workbench, candidates: Sequence[Candidate], found: Search, say: Callable[[str], None]
) -> None:
    """Search the effects that explain the training data.

    Args:
        bench: data, rig and fits.
        candidates: every effect that may be added.
        found: empty; filled as the search goes on, so that an interrupt loses nothing.
        say: told what is being done.
    """
    say("fitting the nominal model")
    baseline = fit_baseline(bench)
    bench.training = tuple(bench.weighted_by(baseline, bench.training))
    baseline = bench.refit(baseline, bench.fine, POLISH if baseline.fit.over_noise < FAR else 1)
    found.keep(baseline)
    say("trying what could explain the rest")
    found.scores = scores_of(bench, baseline, candidates, bench.fine)
    found.left = found.scores
    beam = [baseline]
    while found.rounds < MOST_EFFECTS and _worth_going_on(found):
        found.rounds += 1
        say(f"fitting models with {_words(found.rounds)}")
        grown = _grow(bench, beam, candidates, found)
        if not grown:
            break
        for hypothesis in grown:
            found.keep(hypothesis)
        _prune(bench, found, found.best)
        beam = [h for h in grown if h.fit.objective < HOPELESS * grown[0].fit.objective][:BEAM]
        beam = [found.best] if found.best.fit.over_noise < NEAR else beam
        found.left = scores_of(bench, found.best, candidates, bench.fine)


def _words(count: int) -> str:
    return {1: "one effect", 2: "two effects"}.get(count, f"{count} effects")


def _worth_going_on(found: Search) -> bool:
    """Whether anything is left over, and some effect promises to take a part of it."""
    best = found.best
    if found.rounds and len(best.effects) < found.rounds:
        return False  # one effect more did not pay
    if not found.left:
        return False
    if (
        found.rounds == 1
        and best.fit.over_noise > FAR
        and best.fit.objective > (1.0 - FIRST_SHARE) * found.baseline.fit.objective
    ):
        return False
    promised = found.left[0].gain
    if found.rounds >= 2 and best.fit.over_noise > NEARLY and promised < MATERIAL_GAIN * best.fit.objective:
        return False
    return promised > gain_needed(best.fit)


def fit_baseline(bench: Workbench) -> Hypothesis:
    """The nominal model, from its own values and, if that does not reach the noise, from other places."""
    coarse = COARSE * bench.fine
    centre = {free.path: free.from_unit(0.5) for free in bench.nominal}
    starts = (
        [{}, centre]
        if any(abs(p.to_unit(bench.rig.value(p.path)) - 0.5) > 0.1 for p in bench.nominal)
        else [{}]
    )
    fits = bench.side_by_side(lambda start: bench.fit((), start, coarse, LOOK), starts)
    best = min(fits, key=lambda h: h.fit.objective)
    return bench.refit(best, bench.fine, POLISH if best.fit.over_noise < FAR else POLISH // 2)


_Start = tuple[tuple[Candidate, ...], list[tuple[float, dict[str, float]]]]
"""Effects, and where their fit may begin: squared residuals that are promised, and values."""


def _grow(
    bench: Workbench, beam: Sequence[Hypothesis], candidates: Sequence[Candidate], found: Search
) -> list[Hypothesis]:
    """Every hypothesis of the beam with one effect more; the best are polished and come first."""
    over = found.best.fit.over_noise
    far = over > FAR
    step = bench.fine * (COARSE if far else 2.0 if over > NEAR else 1.0)
    work: dict[frozenset[str], _Start] = {}
    scored_by: dict[frozenset[str], Sequence[Score]] = {}
    for parent in beam:
        scored = (
            found.scores
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
                joints = {c.joint for c in effects}
                kept = {k: v for k, v in parent.values.items() if _of_another_joint(k, joints)}
                starts.append((math.inf, {**kept, **score.start}))
    if not work:
        return []
    if (
        over < NEAR
    ):  # the parent is right but for something small: Gauss-Newton steps from it go straight there
        items = sorted(work.values(), key=lambda item: min(left for left, _ in item[1]))[:FOLLOWED]
        if over > AT_NOISE:
            items += [pair for parent in beam for pair in _pairs(parent, scored_by[parent.ids])]
        fits = bench.side_by_side(lambda i: bench.fit(i[0], min(i[1], key=_first)[1], step, POLISH), items)
        return sorted(fits, key=lambda h: h.fit.objective)
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
    found.given_up.update((h.ids, h) for h in glances)
    bound = HOPELESS * glances[0].fit.objective
    followed = [h for h in glances if h.fit.objective < bound][:FOLLOWED]
    looks = bench.side_by_side(lambda h: bench.refit(h, step, LOOK, tolerance=1e-4, alone=True), followed)
    looks.sort(key=lambda h: h.fit.objective)
    if looks[0].fit.over_noise > NEARLY:
        looks = unstuck(bench, glances[:TRIED_PULLED], looks, step)
    found.given_up.update((h.ids, h) for h in looks)
    nearest = looks[0].fit.over_noise
    near = [h for h in looks if h.fit.over_noise < max(1.5 * nearest, AT_NOISE)][:BEAM]
    polished = bench.side_by_side(lambda h: bench.refit(h, bench.fine, POLISH), near)
    polished.sort(key=lambda h: h.fit.objective)
    return [*polished, *looks[len(near) :]][: max(len(polished), 3)]


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
        joints = {c.joint for c in glance.effects}
        others = {k: v for k, v in glance.values.items() if _of_another_joint(k, joints)}
        starts = [{**others, **start} for start in ({}, *_starts_of(glance.effects))]
        problem = bench.problem(glance.effects, step, part, PULL_S)
        units = [problem.parameters.unit(start) for start in starts]
        errors = [float(np.sum(problem.residuals(unit) ** 2)) for unit in units]
        start = starts[int(np.argmin(errors))]
        return bench.fit(
            glance.effects,
            start,
            step,
            PULLED_STEPS,
            tolerance=1e-3,
            experiments=part,
            pull_time=PULL_S,
            alone=True,
        )

    ahead = sorted(bench.side_by_side(pulled, glances), key=lambda h: h.fit.objective)

    def followed(glance: Hypothesis) -> Hypothesis:
        near = bench.fit(
            glance.effects, glance.values, step, LOOK, tolerance=1e-4, pull_time=PULL_S, alone=True
        )
        return bench.refit(near, step, LOOK, tolerance=1e-4, alone=True)

    again = bench.side_by_side(followed, ahead[:BEAM])
    best = {h.ids: h for h in sorted([*looks, *again], key=lambda h: -h.fit.objective)}
    return sorted(best.values(), key=lambda h: h.fit.objective)


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
        for start in _different(starts)
    ]
    return min(fits, key=lambda h: h.fit.objective)


def _of_another_joint(path: str, joints: set[str]) -> bool:
    """Whether a parameter belongs to a joint, and to none of these."""
    return path.startswith("joints.") and path.split(".")[1] not in joints


def _different(starts: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    kept: list[dict[str, float]] = []
    for start in starts:
        if not any(start == other for other in kept):
            kept.append(start)
    return kept[:2]


def _redundant(parent: Hypothesis, candidate: Candidate) -> bool:
    """Whether both together say nothing new: the effect, and one that the hypothesis has."""
    return any(_contains(c, candidate) for c in parent.effects)


def _contains(first: Candidate, second: Candidate) -> bool:
    """Whether one of two effects at the same joint contains the other."""
    own = first.joint == second.joint
    return own and (second.id in first.effect.contains or first.id in second.effect.contains)


def _prune(bench: Workbench, found: Search, hypothesis: Hypothesis) -> None:
    """Fit the best hypothesis again without each of its effects, from where it ended."""
    work = [tuple(c for c in hypothesis.effects if c is not effect) for effect in hypothesis.effects]
    fits = bench.side_by_side(lambda rest: bench.fit(rest, hypothesis.values, bench.fine, POLISH), work)
    for fitted in fits:
        found.keep(fitted)
