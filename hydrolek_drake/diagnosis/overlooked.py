"""Effects that promise nothing beside a model, and yet are missing from it.

Where a joint sticks and slips, or a controller holds it, fits end before the bottom, and a model that lacks a small
effect may have bent its numbers so far that the effect promises nothing there to first order. So a model that explains
the training data is fitted on, and held against every effect again. Where it may leave more than noise ahead, every
effect is fitted beside the rig's own numbers, with pulled rollouts that are let go; where it surely does, also beside
the model's.
"""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.candidates import Candidate, redundant, widenings
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, GLANCE, LOOK, MORE_AHEAD, MOST_EFFECTS
from hydrolek_drake.diagnosis.gains import cost_of, gain_needed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled, let_go
from hydrolek_drake.diagnosis.score import scores_of
from hydrolek_drake.diagnosis.unsticking import begun_anew
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

STARTS = 2
"""From so many of the places where searches of an effect begin: one to either side for what has a sign."""

FOLLOWED = 4
"""So many effects go on to the end."""


def enlargeable(judged: Judged) -> bool:
    """Whether a model explains the training data, and may have one effect more.

    Args:
        judged: the most probable model.
    """
    hypothesis = judged.hypothesis
    return hypothesis.fit.over_noise <= EXPLAINED and len(hypothesis.effects) < MOST_EFFECTS


def overlooked(
    bench: Workbench, judged: Judged, candidates: Sequence[Candidate], held_out: Sequence[Experiment]
) -> list[Hypothesis]:
    """The model with each effect more, or other numbers, that brings enough of the training data, and better ahead.

    Args:
        bench: fits, and the training data.
        judged: the most probable model.
        candidates: every effect that may be added.
        held_out: recordings that choose among them.

    Returns:
        the one that leaves least of both data first; none if nothing was overlooked.
    """
    parent = bench.refit(judged.hypothesis, bench.fine, LOOK)
    needed = gain_needed(parent.fit)
    ended: list[Hypothesis] = []
    if judged.over_noise > ABOVE_NOISE:
        ended = _let_go(bench, parent, candidates)
    promising = [s for s in scores_of(bench, parent, candidates, bench.fine) if s.gain > needed]
    begun = bench.side_by_side(
        lambda s: bench.fit((*parent.effects, s.candidate), {**parent.values, **s.start}, bench.fine, GLANCE),
        [s for s in promising if not redundant(parent.effects, s.candidate)][:FOLLOWED],
    )
    if judged.over_noise > MORE_AHEAD:
        begun += _begun(bench, parent, candidates)[:FOLLOWED]
    ended += bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), begun)

    def ahead(hypothesis: Hypothesis) -> float:
        left = bench.residuals(hypothesis, held_out, bench.fine)
        return float(left @ left)

    as_judged = bench.refit(judged.hypothesis, bench.fine, 1)
    before = ahead(as_judged)
    better = [
        (cost_of(h) + left, h)
        for h in (parent, *ended)
        if h.fit.objective < as_judged.fit.objective - needed and (left := ahead(h)) < before
    ]
    return [h for _, h in sorted(better, key=_left)]


def _let_go(bench: Workbench, parent: Hypothesis, candidates: Sequence[Candidate]) -> list[Hypothesis]:
    """The model, with every effect more, and with what contains one of its own, from the rig's own numbers.

    The squared residuals of tightly pulled rollouts have few hollows, and tell which effects to follow; what is
    slow, or a controller hides, only free ones see.
    """
    instead = [parent.effects, *(changed for _, _, changed in widenings(parent.effects, candidates))]
    sets = [*instead, *((*parent.effects, c) for c in candidates if _may_be_added(parent, c))]

    def pulled(effects: tuple[Candidate, ...]) -> Hypothesis:
        starts = begun_anew(bench, effects, parent.values)
        return fit_pulled(bench, effects, starts, bench.fine, bench.training)

    near = bench.side_by_side(pulled, sets)
    promising = [*near[: len(instead)], *sorted(near[len(instead) :], key=_objective)[:FOLLOWED]]
    glances = bench.side_by_side(lambda h: bench.refit(h, bench.fine, GLANCE, tolerance=1e-3), near)
    begun = [
        *bench.side_by_side(lambda h: let_go(bench, h), promising),
        *sorted(glances, key=_objective)[:FOLLOWED],
    ]
    return bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), begun)


def _may_be_added(parent: Hypothesis, candidate: Candidate) -> bool:
    if redundant(parent.effects, candidate) or candidate.size_path in parent.ids:
        return False
    return not candidate.moments  # their moments were all gone through


def _begun(bench: Workbench, parent: Hypothesis, candidates: Sequence[Candidate]) -> list[Hypothesis]:
    """A few steps with every effect, the best first."""
    work = [
        ((*parent.effects, candidate), {**parent.values, **start})
        for candidate in candidates
        if _may_be_added(parent, candidate)
        for start in candidate.starts[:: math.ceil(len(candidate.starts) / STARTS)]
    ]
    begun = bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, GLANCE), work)
    best = {h.ids: h for h in sorted(begun, key=_objective, reverse=True)}
    return sorted(best.values(), key=_objective)


def _objective(hypothesis: Hypothesis) -> float:
    return hypothesis.fit.objective


def _left(pair: tuple[float, Hypothesis]) -> float:
    return pair[0]
