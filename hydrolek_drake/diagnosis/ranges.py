"""Ranges of a search that prove too narrow.

An effect's range follows from the machine's natural scales: what a worn machine may have. Where the best model has an
effect at the far end of its range and does not explain the data, the machine may have more of it, and what is added
to that model only makes up for the rest.
"""

from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.score import AT_BOUND
from hydrolek_drake.diagnosis.workbench import Hypothesis

WIDER = 4.0
"""A range that proves too narrow is widened so many times."""


def at_the_end(hypothesis: Hypothesis) -> list[Candidate]:
    """Effects of a fitted model whose size lies at the far end of a range that could be wider."""
    return [
        candidate
        for candidate in hypothesis.effects
        if _at_far_end(candidate, hypothesis.values[candidate.size_path]) and widened(candidate) != candidate
    ]


def widened(candidate: Candidate) -> Candidate:
    """The same effect, searched further, as far as its size can be at all."""
    size, (lowest, highest) = candidate.size, candidate.utmost
    if candidate.effect.weakens:
        lower, upper = max(size.lower / WIDER, lowest), size.upper
    else:
        lower, upper = max(min(size.lower, size.lower * WIDER), lowest), min(size.upper * WIDER, highest)
    free = tuple(replace(f, lower=lower, upper=upper) if f is size else f for f in candidate.free)
    return replace(candidate, free=free)


def replaced(candidates: Sequence[Candidate], new: Candidate) -> tuple[Candidate, ...]:
    """Candidates with another one in the place of that of the same effect and joint."""
    return tuple(new if c.size_path == new.size_path else c for c in candidates)


def _at_far_end(candidate: Candidate, value: float) -> bool:
    place = candidate.size.to_unit(value)
    if candidate.effect.weakens:
        return place < AT_BOUND
    return place > 1.0 - AT_BOUND or (candidate.size.lower < 0.0 and place < AT_BOUND)
