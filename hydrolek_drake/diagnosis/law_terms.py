"""What each term of a law promises, beside a model and terms that it has already: linear algebra, as in `score`."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.law_inputs import Input
from hydrolek_drake.diagnosis.laws import CONSTANT, TERMS, Span, Term, law_record
from hydrolek_drake.diagnosis.score import Across, gain_of
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.rollout.lanes import roll_out_lanes

TRIED = 1e-3
"""Amplitude of a trial, as a fraction of the input's scale: small enough to be linear."""

SIZES = (0.3, 0.1, 0.03)
"""Larger amplitudes, where a law may not act in proportion any more."""


TOGETHER = 2.0
"""Two terms are tried at once where together they promise so many times what the better one does alone."""


@dataclass(frozen=True)
class Fitted:
    """A model to which terms of a law may be added.

    Attributes:
        records: its parameters.
        span: what the variables of the terms are told in.
        step: of the integration [s].
        across: takes out of residuals what its parameters can undo.
        off: its parameters' distances from their priors.
        has: terms that it has already, as the rollout takes them; None for none.
    """

    records: np.ndarray
    span: Span
    step: float
    across: Across
    off: np.ndarray
    has: np.ndarray | None = None


@dataclass(frozen=True)
class Promise:
    """What one term, or two, would do.

    Attributes:
        terms: at one input.
        gain: fall of the squared residuals.
        starts: where their amplitudes may begin, in scales of the input.
    """

    terms: tuple[Term, ...]
    gain: float
    starts: tuple[float, ...]


def terms_scored(bench: Workbench, model: Fitted, given: Input, terms: Sequence[Term]) -> list[Promise]:
    """What each term at an input promises, and the constant with another one where they do so together.

    Args:
        bench: training data.
        model: the model to which they are added.
        given: the input.
        terms: of which those that act at this stage are tried.
    """
    bench.alive()
    still = np.zeros(model.off.size)

    def responses(asked: Sequence[tuple[Term, float]]) -> list[np.ndarray]:
        """Residuals with a term of a size each, of the input's scale."""
        runs = []
        for term, size in asked:
            law = law_record(given.probe, model.span, term, given.scale * size)
            if model.has is not None:
                law = np.concatenate([model.has, law])
            runs += [e.run(model.records, model.step, law=law) for e in bench.training]
        made = iter(roll_out_lanes(runs))
        return [np.concatenate([e.residuals(next(made).signals) for e in bench.training]) for _ in asked]

    (here,) = responses([(TERMS[0], 0.0)])
    rest = model.across(np.concatenate([here, model.off]))

    def changes(asked: Sequence[tuple[Term, float]]) -> list[np.ndarray]:
        """What these change of what is left; NaN where a rollout diverged."""
        return [
            model.across(np.concatenate([there - here, still]))
            if np.isfinite(there).all()
            else np.full_like(rest, np.nan)
            for there in responses(asked)
        ]

    tried = [term for term in terms if term.meant_for(given)]
    columns = changes([(term, TRIED) for term in tried])
    promised = []
    for column in columns:
        gain, amplitudes = gain_along(column[:, None], rest)
        if given.one_sided and amplitudes[0] < 0.0:
            gain, amplitudes = 0.0, (0.0,)
        promised.append((gain, amplitudes[0]))
    others = [sign * s for s in SIZES for sign in ((1.0,) if given.one_sided else (1.0, -1.0))]
    found = []
    for term, (gain, first) in zip(tried, promised, strict=True):
        bench.alive()
        sizes = [first, *others]
        moved = changes([(term, size) for size in sizes])
        remaining = [float(np.sum((rest + change) ** 2)) for change in moved]
        gain = max([gain, *(gain_of(change, rest) for change in moved[1:])])
        start, least = first, remaining[0]
        for size, left in zip(others, remaining[1:], strict=True):
            if left < least:
                least, start = left, size
        found.append(Promise((term,), gain, (start,)))
    return found + only_together(found, columns, rest)


def only_together(alone: Sequence[Promise], columns: Sequence[np.ndarray], rest: np.ndarray) -> list[Promise]:
    """The constant with the term that promises most beside it, if that is far more than either promises alone.

    What a pressure opens has a share that is shut and one that grows with the pressure. Where a controller keeps the
    pressures near one place each of them undoes what the other does, so that neither helps without the other.

    Args:
        alone: what single terms at an input promise.
        columns: change of the residuals with each, for `TRIED` of the input's scale. # (values,) each
        rest: what is left. # (values,)

    Returns:
        One pair, or none.
    """
    constant = next((k for k, each in enumerate(alone) if each.terms[0].name == CONSTANT), None)
    if constant is None:
        return []
    pairs = []
    for k, each in enumerate(alone):
        if k != constant:
            gain, starts = gain_along(np.stack([columns[constant], columns[k]], axis=1), rest)
            if gain > TOGETHER * max(alone[constant].gain, each.gain):
                pairs.append(Promise((*alone[constant].terms, *each.terms), gain, starts))
    return [max(pairs, key=lambda pair: pair.gain)] if pairs else []


def gain_along(columns: np.ndarray, rest: np.ndarray) -> tuple[float, tuple[float, ...]]:
    """Fall of the squared residuals if the columns take their best multiples, and these, in scales of the input.

    A column of a rollout that diverged promises nothing.
    """
    norms = np.linalg.norm(columns, axis=0)
    if not np.isfinite(columns).all() or not norms.all():
        return 0.0, (0.0,) * columns.shape[1]
    multiples, *_ = np.linalg.lstsq(columns / norms, -rest, rcond=None)
    fitted = columns / norms @ multiples
    amplitudes = np.clip(TRIED * multiples / norms, -0.9, 0.9)
    return float(fitted @ fitted), tuple(amplitudes.tolist())
