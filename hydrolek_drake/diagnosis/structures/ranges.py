"""Ranges of a search that prove too narrow.

An effect's range follows from the machine's natural scales: what a worn machine may have. Where the best model has an
effect at the far end of its range and does not explain the data, the machine may have more of it, and what is added
to that model only makes up for the rest. The same goes for what else an effect has, such as the speed over which a
friction fades, at either end.
"""

from collections.abc import Mapping
from dataclasses import replace

from hydrolek_drake.diagnosis.search.settings import AT_BOUND, WIDER
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis
from hydrolek_drake.identification.parameter_set import Free


def ended(hypothesis: Hypothesis, candidate: Candidate) -> list[Free]:
    """Parameters of an effect, but for its size and moments, that were fitted to an end of what is searched.

    How quickly an oil warms up or how far a cushion reaches is no more than a natural scale of the machine allows;
    what asks for more may be something else, which the effect only imitates.

    Args:
        hypothesis: a fitted model.
        candidate: one of its effects.
    """
    others = [f for f in candidate.free if f.path != candidate.size_path and f not in candidate.moments]
    places = [(free, free.to_unit(hypothesis.values[free.path])) for free in others]
    return [free for free, place in places if not AT_BOUND < place < 1.0 - AT_BOUND]


def widened(candidate: Candidate, values: Mapping[str, float]) -> Candidate:
    """The same effect, searched further where a parameter lies at an end, as far as it can be at all.

    Args:
        candidate: the effect.
        values: full path -> fitted value.
    """
    free = tuple(_further(candidate, f, values[f.path]) for f in candidate.free)
    return replace(candidate, free=free)


def _further(candidate: Candidate, free: Free, value: float) -> Free:
    """A parameter with a wider range if it lies at an end of its own; a size not at that where the effect is off."""
    lowest, highest = candidate.utmost.get(free.path, (free.lower, free.upper))
    place = free.to_unit(value)
    size = free.path == candidate.size_path
    if place > 1.0 - AT_BOUND and not (size and candidate.effect.weakens):
        upper = min(free.upper * WIDER, highest)
        mirrored = size and free.lower < 0.0
        return replace(free, lower=max(free.lower * WIDER, lowest) if mirrored else free.lower, upper=upper)
    if place < AT_BOUND and free.lower < 0.0:
        upper = min(free.upper * WIDER, highest) if size else free.upper
        return replace(free, lower=max(free.lower * WIDER, lowest), upper=upper)
    if place < AT_BOUND and free.lower > 0.0 and (not size or candidate.effect.weakens):
        return replace(free, lower=max(free.lower / WIDER, lowest))
    return free
