"""Effects that promise nothing beside a model, and yet are missing from it.

Where a joint sticks and slips, or a controller holds it, a model that lacks a small effect may have bent its numbers
so far that the effect promises nothing there to first order. The training data are explained; what the model leaves
ahead is more than noise. Then every effect is fitted from there, whether it promises anything or not.
"""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.candidates import Candidate, redundant
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import GLANCE, LOOK, MOST_EFFECTS, NOISE_KNOWN, POLISH
from hydrolek_drake.diagnosis.gains import cost_of, gain_needed
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment

STARTS = 2
"""From so many of the places where searches of an effect begin: one to either side for what has a sign."""


MORE = 1.0 + 4.0 * NOISE_KNOWN
"""A model lacks something ahead if it leaves so many times the noise there, whatever its uncertainty accounts for: four
times what the noise is known to. Numbers that are bent are uncertain too."""

FOLLOWED = 5
"""So many effects go on to the end."""


def wanting(judged: Judged) -> bool:
    """Whether a model explains the training data, and leaves more than noise ahead.

    Args:
        judged: the most probable model.
    """
    explains = judged.hypothesis.fit.over_noise <= EXPLAINED
    return explains and judged.over_noise > MORE and len(judged.hypothesis.effects) < MOST_EFFECTS


def overlooked(
    bench: Workbench, model: Hypothesis, candidates: Sequence[Candidate], held_out: Sequence[Experiment]
) -> list[Hypothesis]:
    """The model with each effect more that brings enough of the training data, and does better ahead.

    Args:
        bench: fits, and the training data.
        model: fitted to these.
        candidates: every effect that may be added.
        held_out: recordings that choose among them.

    Returns:
        the one that leaves least of both data first; none if nothing was overlooked.
    """
    parent = bench.refit(model, bench.fine, POLISH)
    work = [
        ((*parent.effects, candidate), {**parent.values, **start})
        for candidate in candidates
        if not redundant(parent.effects, candidate)
        and candidate.size_path not in parent.ids
        and not candidate.moments  # their moments were all gone through
        for start in candidate.starts[:: math.ceil(len(candidate.starts) / STARTS)]
    ]
    begun = bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, GLANCE), work)
    ahead_of_others = {h.ids: h for h in sorted(begun, key=_objective, reverse=True)}
    followed = sorted(ahead_of_others.values(), key=_objective)[:FOLLOWED]
    ended = bench.side_by_side(lambda h: bench.refit(h, bench.fine, LOOK), followed)
    needed = parent.fit.objective - gain_needed(parent.fit)

    def ahead(hypothesis: Hypothesis) -> float:
        left = bench.residuals(hypothesis, held_out, bench.fine)
        return float(left @ left)

    before = ahead(parent)
    better = [
        (cost_of(h) + left, h) for h in ended if h.fit.objective < needed and (left := ahead(h)) < before
    ]
    return [h for _, h in sorted(better, key=_left)]


def _objective(hypothesis: Hypothesis) -> float:
    return hypothesis.fit.objective


def _left(pair: tuple[float, Hypothesis]) -> float:
    return pair[0]
