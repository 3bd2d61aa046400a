"""Other hollows of the squared residuals, for a model that explains the training data and fails on held-out data.

Where a joint sticks and slips, the training data may have many hollows of nearly the same depth, and which of them is
the deepest tells little. The likelihood of the held-out data under a set of effects is then a sum over hollows, each
weighted by its likelihood on the training data; the hollow that leaves least of both outweighs the others (Laplace's
approximation at several modes; MacKay, Information Theory, Inference, and Learning Algorithms, 2003, chapter 27).
"""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.candidates import Candidate, widenings
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.gains import cost_of
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.unsticking import begun_anew
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, key_of
from hydrolek_drake.identification.experiment import Experiment

MOST_MODELS = 3
"""So many models that explain the training data are fitted elsewhere at most, each also with what contains it."""

MOST_STARTS = 9
"""From at most so many places each, evenly among those where searches of its effects begin."""


def strayed(judged: Judged) -> bool:
    """Whether a model explains the training data, and its uncertainty does not account for what it leaves ahead."""
    return judged.hypothesis.fit.over_noise <= EXPLAINED < judged.unaccounted


def deepest(
    bench: Workbench,
    judged: Sequence[Judged],
    candidates: Sequence[Candidate],
    held_out: Sequence[Experiment],
    most_models: int = MOST_MODELS,
) -> list[Hypothesis]:
    """Of each model that explains the training data, and of what contains it, the fit that leaves least of both data.

    Args:
        bench: fits, to the training data alone.
        judged: models, of which those with effects are fitted again.
        candidates: every effect that there is.
        held_out: recordings that choose among the fits of a model.
        most_models: so many models that explain the training data are fitted elsewhere.

    Returns:
        one fit for each set of effects, the one that leaves least first.
    """
    explaining = sorted(
        (j.hypothesis for j in judged if j.hypothesis.effects and j.hypothesis.fit.over_noise <= EXPLAINED),
        key=cost_of,
    )
    sets: dict[frozenset[str], tuple[tuple[Candidate, ...], Hypothesis]] = {}
    for hypothesis in explaining[:most_models]:
        wider = (changed for _, _, changed in widenings(hypothesis.effects, candidates))
        for effects in (hypothesis.effects, *wider):
            sets.setdefault(key_of(effects), (effects, hypothesis))
    work = [
        (effects, start)
        for effects, near in sets.values()
        for start in _evenly(begun_anew(bench, effects, near.values))
    ]
    fits = bench.side_by_side(lambda item: bench.fit(item[0], item[1], bench.fine, LOOK), work)
    fits += explaining

    def left(hypothesis: Hypothesis) -> float:
        ahead = bench.residuals(hypothesis, held_out, bench.fine)
        return cost_of(hypothesis) + float(ahead @ ahead)

    chosen: dict[frozenset[str], Hypothesis] = {}
    for _, hypothesis in sorted(zip(bench.side_by_side(left, fits), fits, strict=True), key=_first):
        chosen.setdefault(hypothesis.ids, hypothesis)
    return list(chosen.values())


def _first(pair: tuple[float, Hypothesis]) -> float:
    return pair[0]


def _evenly(starts: Sequence[dict[str, float]]) -> Sequence[dict[str, float]]:
    return starts[:: math.ceil(len(starts) / MOST_STARTS)]
