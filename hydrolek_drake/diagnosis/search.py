"""The search for effects: add one at a time, several hypotheses abreast, and try to remove each again.

Everything here is fitted to the training data alone; which hypothesis is right is decided elsewhere, on data
that none of them was fitted to (`evidence`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.score import Score, scores_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of
from hydrolek_drake.identification.least_squares import Fit

COARSE = 4.0
"""Integration step of the first fits over the rig's own: 16 times its error, a quarter of its time."""

FAR, NEAR = 3.0, 1.3
"""A model this many times above the noise is searched with the coarse step, or with twice the rig's own: the
error of the step must stay far below what is to be explained."""

GLANCE_S = 20.0
"""First fits see so many seconds of a recording: errors that grow with time are smaller, and so is the work."""

GAIN_NEEDED = 12.0
"""Smallest gain (fall of the squared residuals) that is followed up: 3.5 standard deviations of one size."""

FIDELITY = 0.004
"""Fall of the squared residuals, as a share of the values, below which an effect is not told from what every
model leaves out: 0.2 % of the noise's rms."""

AT_NOISE = 1.03
"""A model within 3 % of the noise: the estimate of the noise itself is good to 1 to 2 %."""

MOST_EFFECTS = 3
"""At most so many effects are searched together."""

BEAM = 4
"""So many hypotheses are extended by a further effect."""

GLANCE, LOOK, POLISH = 4, 25, 12
"""Trust-region steps of a first fit, of one that is followed up, and of one with the rig's own step."""

FOLLOWED = 5
"""So many of the first fits are followed up."""

HOPELESS = 4.0
"""First fits whose squared residuals are so many times the best one's are not followed up."""


@dataclass
class Search:
    """What was tried.

    Attributes:
        baseline: the nominal model, fitted.
        hypotheses: every set of effects that was fitted with the rig's own step, by its key.
        scores: of the effects against the fitted nominal model.
        left: gains of the effects that the best model has not.
        rounds: how many effects at once were searched.
    """

    baseline: Hypothesis
    hypotheses: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    scores: list[Score] = field(default_factory=list)
    left: list[Score] = field(default_factory=list)
    rounds: int = 0

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of these effects."""
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis
            if not hypothesis.effects:
                self.baseline = hypothesis

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


def search(bench: Workbench, candidates: Sequence[Candidate], say: Callable[[str], None]) -> Search:
    """Search the effects that explain the training data.

    Args:
        bench: data, rig and fits.
        candidates: every effect that may be added.
        say: told what is being done.
    """
    say("fitting the nominal model")
    baseline = fit_baseline(bench)
    bench.training = tuple(bench.weighted_by(baseline, bench.training))
    baseline = bench.refit(baseline, bench.fine, POLISH)
    found = Search(baseline)
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
        _prune(bench, found, grown[:2])
        beam = [h for h in grown if h.fit.objective < HOPELESS * grown[0].fit.objective][:BEAM]
        found.left = scores_of(bench, found.best, candidates, bench.fine)
    return found


def _words(count: int) -> str:
    return {1: "one effect", 2: "two effects"}.get(count, f"{count} effects")


def _worth_going_on(found: Search) -> bool:
    """Whether anything is left over, and some effect promises to take a part of it."""
    best = found.best
    if found.rounds and len(best.effects) < found.rounds:
        return False  # one effect more did not pay
    return bool(found.left) and found.left[0].gain > gain_needed(best.fit)


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


def _grow(
    bench: Workbench, beam: Sequence[Hypothesis], candidates: Sequence[Candidate], found: Search
) -> list[Hypothesis]:
    """Every hypothesis of the beam with one effect more; the best are polished and come first."""
    over = found.best.fit.over_noise
    far = over > FAR
    step = bench.fine * (COARSE if far else 2.0 if over > NEAR else 1.0)
    work: dict[frozenset[str], tuple[tuple[Candidate, ...], list[tuple[float, dict[str, float]]]]] = {}
    for parent in beam:
        scored = (
            found.scores
            if not parent.effects and not far
            else scores_of(bench, bench.refit(parent, step, 1) if far else parent, candidates, step)
        )
        for score in scored:
            if _redundant(parent, score.candidate) or (
                not far and score.gain < 0.5 * gain_needed(parent.fit)
            ):
                continue
            effects = (*parent.effects, score.candidate)
            starts = work.setdefault(key_of(effects), (effects, []))[1]
            starts.append((score.left, {**parent.values, **score.start}))
            if far:  # the parent's values may have gone far astray to make up for what is missing
                own = {c.size_path.rpartition(".")[0] for c in effects}
                kept = {k: v for k, v in parent.values.items() if k.rpartition(".")[0] in own}
                starts.append((math.inf, {**kept, **score.start}))
    if not work:
        return []
    glances = bench.side_by_side(
        lambda item: _glance(bench, item[0], [start for _, start in item[1]], step), list(work.values())
    )
    glances.sort(key=lambda h: h.fit.objective)
    bound = HOPELESS * glances[0].fit.objective
    followed = [h for h in glances if h.fit.objective < bound][:FOLLOWED]
    looks = bench.side_by_side(lambda h: bench.refit(h, step, LOOK, tolerance=1e-4), followed)
    looks.sort(key=lambda h: h.fit.objective)
    nearest = looks[0].fit.over_noise
    near = [h for h in looks if h.fit.over_noise < max(1.5 * nearest, AT_NOISE)][:BEAM]
    polished = bench.side_by_side(lambda h: bench.refit(h, bench.fine, POLISH), near)
    polished.sort(key=lambda h: h.fit.objective)
    return [*polished, *looks[len(near) :]][: max(len(polished), 3)]


def _glance(
    bench: Workbench, effects: Sequence[Candidate], starts: Sequence[dict[str, float]], step: float
) -> Hypothesis:
    """A few steps from each start."""
    part = [experiment.until(GLANCE_S) for experiment in bench.training]
    fits = [
        bench.fit(effects, start, step, GLANCE, tolerance=1e-3, experiments=part)
        for start in _different(starts)
    ]
    return min(fits, key=lambda h: h.fit.objective)


def _different(starts: Sequence[dict[str, float]]) -> list[dict[str, float]]:
    kept: list[dict[str, float]] = []
    for start in starts:
        if not any(start == other for other in kept):
            kept.append(start)
    return kept[:2]


def _redundant(parent: Hypothesis, candidate: Candidate) -> bool:
    """Whether one of two effects contains the other, so that both together say nothing new."""
    contains = {other for c in parent.effects for other in c.effect.contains}
    return candidate.id in contains or any(c.id in candidate.effect.contains for c in parent.effects)


def _prune(bench: Workbench, found: Search, grown: Sequence[Hypothesis]) -> None:
    """Fit each of the best again without one of its effects, from where it ended."""
    work = []
    for hypothesis in grown:
        for effect in hypothesis.effects:
            rest = tuple(c for c in hypothesis.effects if c is not effect)
            work.append((rest, hypothesis.values))
    fits = bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, POLISH), work)
    for hypothesis in fits:
        found.keep(hypothesis)
