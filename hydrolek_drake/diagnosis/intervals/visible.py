"""The smallest size of each effect that a recording would have shown.

A size is seen if what it changes, less what the model's own parameters undo of it, has the squared size that one more
effect must bring (`search.cost.gain_needed`). The change is not in proportion to the size: much of what a large effect
does beyond the reach of the parameters is of second order. So the size is sought by rollouts and not by a rule of
three.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.fitting.promise import Promise
from hydrolek_drake.diagnosis.settings import EXPERIMENTS, FITS, GAINS
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.cost import gain_needed
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.effects import EFFECTS


@dataclass(frozen=True)
class Visible:
    """Smallest size of an effect that would have been seen (SI)."""

    candidate: Candidate
    size: float


def visible_sizes(
    bench: Workbench, hypothesis: Hypothesis, promises: Sequence[Promise]
) -> tuple[Visible, ...]:
    """Smallest size of each effect that the training data would have shown beside a model, by id.

    Args:
        bench: fits.
        hypothesis: the model, fitted.
        promises: of effects beside it; a first estimate of their sizes. Those that the model has are left out.
    """
    across = Across(hypothesis.fit)
    own = hypothesis.ids
    wanted = [
        (p.candidate, p)
        for p in promises
        if isinstance(p.candidate, Candidate)
        and p.candidate.size_path not in own
        and 0.0 < p.visible_from < math.inf
    ]
    sizes = bench.side_by_side(lambda one: _visible_size(bench, hypothesis, one[0], one[1], across), wanted)
    found = [
        Visible(candidate, max(size, candidate.beneath))
        for (candidate, _), size in zip(wanted, sizes, strict=True)
        if math.isfinite(size)
    ]
    return tuple(sorted(found, key=lambda v: v.candidate.id))


def _visible_size(
    bench: Workbench, hypothesis: Hypothesis, candidate: Candidate, promise: Promise, across: Across
) -> float:
    """That of one effect; NaN if none in its range is seen."""
    path = candidate.size_path
    effects = (*hypothesis.effects, candidate)
    problem = bench.problem(effects, bench.step_for(effects, FITS.coarse))
    start = promise.starts[0]
    sign = math.copysign(1.0, start[path])
    alone = {**hypothesis.values, **start, **_without_special_cases(candidate)}
    power = -1.0 if candidate.effect.weakens else 1.0  # a spring that is seen is at most so stiff

    def residuals(size: float) -> np.ndarray:
        inside = min(max(sign * size, candidate.size.lower), candidate.size.upper)
        return problem.residuals(problem.parameters.unit({**alone, path: inside}))

    # a play without a gap is still a contact that gives way: what counts is what the size does
    nothing = residuals(promise.visible_from * FITS.negligible**power)
    needed = max(GAINS.visible, gain_needed(hypothesis.fit))
    unmoved = np.zeros_like(hypothesis.fit.off_prior)
    size, seen = promise.visible_from, math.nan
    for _ in range(EXPERIMENTS.rounds):
        change = across(np.concatenate([residuals(size) - nothing, unmoved]))
        shown = float(change @ change) / needed
        if shown >= 1.0:
            seen = size
            if shown <= EXPERIMENTS.near_enough:
                break
        elif math.isfinite(seen):
            break
        stride = math.sqrt(EXPERIMENTS.aim / max(shown, np.finfo(float).tiny))
        size *= min(max(stride, 1.0 / EXPERIMENTS.stride), EXPERIMENTS.stride) ** power
    bench.evaluations += problem.evaluations
    return seen


def _without_special_cases(candidate: Candidate) -> dict[str, float]:
    """Full path -> neutral value of what its special cases are in it: the Coulomb part of Stribeck friction."""
    special = {EFFECTS[contained].size for contained in candidate.effect.contains}
    neutral = {p.name: p.neutral for p in candidate.effect.parameters if p.name in special}
    return {
        f"{candidate.path}.{name}": value
        for name, value in neutral.items()
        if value is not None and name != candidate.effect.size
    }
