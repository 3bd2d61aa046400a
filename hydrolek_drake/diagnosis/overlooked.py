"""Effects that promise nothing beside a model, and yet are missing from it.

Where a joint sticks and slips, or a controller holds it, fits end before the bottom, and a model that lacks a small
effect may have bent its numbers so far that the effect promises nothing there to first order. So a model that explains
the training data is fitted on, and held against every effect again. Where it leaves more than noise ahead, every
effect is fitted from there, whether it promises anything or not.
"""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.candidates import Candidate, redundant
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import GLANCE, LOOK, MORE_AHEAD, MOST_EFFECTS
from hydrolek_drake.diagnosis.gains import cost_of, gain_needed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.score import scores_of
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

STARTS = 2
"""From so many of the places where searches of an effect begin: one to either side for what has a sign."""

FOLLOWED = 5
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
    """The model with each effect more that brings enough of the training data, and does better ahead.

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
    if judged.over_noise > MORE_AHEAD:
        begun = _begun(bench, parent, candidates)[:FOLLOWED]
    else:
        promising = [s for s in scores_of(bench, parent, candidates, bench.fine) if s.gain > needed]
        begun = bench.side_by_side(
            lambda s: bench.fit(
                (*parent.effects, s.candidate), {**parent.values, **s.start}, bench.fine, GLANCE
            ),
            [s for s in promising if not redundant(parent.effects, s.candidate)][:FOLLOWED],
        )
    ended = bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), begun)

    def ahead(hypothesis: Hypothesis) -> float:
        left = bench.residuals(hypothesis, held_out, bench.fine)
        return float(left @ left)

    before = ahead(parent)
    better = [
        (cost_of(h) + left, h)
        for h in ended
        if h.fit.objective < parent.fit.objective - needed and (left := ahead(h)) < before
    ]
    return [h for _, h in sorted(better, key=_left)]


def _begun(bench: Workbench, parent: Hypothesis, candidates: Sequence[Candidate]) -> list[Hypothesis]:
    """A few steps with every effect, the best first."""
    work = [
        ((*parent.effects, candidate), {**parent.values, **start})
        for candidate in candidates
        if not redundant(parent.effects, candidate)
        and candidate.size_path not in parent.ids
        and not candidate.moments  # their moments were all gone through
        for start in candidate.starts[:: math.ceil(len(candidate.starts) / STARTS)]
    ]
    begun = bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, GLANCE), work)
    best = {h.ids: h for h in sorted(begun, key=_objective, reverse=True)}
    return sorted(best.values(), key=_objective)


def _objective(hypothesis: Hypothesis) -> float:
    return hypothesis.fit.objective


def _left(pair: tuple[float, Hypothesis]) -> float:
    return pair[0]
