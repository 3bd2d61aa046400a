"""How much an effect could improve a fit, from rollouts at a few sizes and linear algebra alone.

Around a fitted model the residuals are r + J d for a small change d of its parameters. With an effect at some
size the residuals are r + e. What the fitted parameters cannot undo of e is its part across the columns of J.
The gain of the effect is the fall of the squared residuals if it takes its best multiple:

    gain = (e . r)^2 / (e . e), both across J, if they point against each other.

It is the score test of Rao (1948) with finite differences, so it also sees effects that start like a play.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.unsticking import different
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.least_squares import Fit

SHRUNK = (1.0, 0.1, 0.01)
"""Sizes at which an effect is tried, as multiples of the starts of its search. Under control, where a joint sticks, a
drift of a tenth of where its search begins may promise hardly anything, and a third of that all it takes."""

ESTIMATING = 0.1
"""Sizes from this multiple on tell from where an effect is seen: smaller ones may show only what comes with it, such as
the Coulomb part of Stribeck friction."""


@dataclass(frozen=True)
class Score:
    """One effect held against what a model leaves.

    Attributes:
        candidate: the effect.
        gain: predicted fall of the squared residuals, in units of the noise squared.
        start: full path -> value at which its fit should begin.
        moments: full path -> value, for an effect that begins at some moment: those at which searches begin, in the
            order of what the effect's best multiple would gain.
        left: squared residuals with the effect at its start, after the best change of the fitted parameters.
        visible_from: size of the effect (SI) whose gain would be `VISIBLE`, in proportion to the sizes that were
            tried; a first estimate, see `visible`.
        change: of the residuals across the fitted parameters' columns, at the size of that gain. # (values,)
        rest: what the model leaves, across these columns. # (values,)
    """

    candidate: Candidate
    gain: float
    start: dict[str, float]
    moments: tuple[dict[str, float], ...]
    left: float
    visible_from: float
    change: np.ndarray
    rest: np.ndarray


AT_BOUND = 1e-3
"""A fitted parameter this close to an end of its range (in ranges) cannot move on."""

VISIBLE = 16.0
"""Gain at which an effect would have been seen: four standard deviations of its size."""


class Across:
    """Projection across the columns of a fit's Jacobian."""

    def __init__(self, fit: Fit) -> None:
        """Orthonormal basis of the columns; those that say nothing or cannot move on are left out."""
        norms = np.linalg.norm(fit.jacobian, axis=0)
        use = (norms > 0.0) & (np.abs(fit.unit - 0.5) < 0.5 - AT_BOUND)
        kept = fit.with_prior[:, use] / norms[use]
        if kept.shape[1]:
            left, singular, _ = np.linalg.svd(kept, full_matrices=False)
            self.basis = left[:, singular > 1e-8 * singular[0]]
        else:
            self.basis = np.zeros((len(fit.with_prior), 0))

    def __call__(self, vector: np.ndarray) -> np.ndarray:
        """The part of a vector that the columns cannot make."""
        return vector - self.basis @ (self.basis.T @ vector)


def scores_of(
    bench: Workbench, hypothesis: Hypothesis, candidates: Sequence[Candidate], step: float
) -> list[Score]:
    """Score every candidate that the model does not have yet, the most promising first."""
    own = {candidate.size_path for candidate in hypothesis.effects}
    across = Across(hypothesis.fit)
    free = [candidate for candidate in candidates if candidate.size_path not in own]
    here = _left_by(bench, hypothesis, step)
    scored = bench.side_by_side(
        lambda c: _score(bench, hypothesis, (*hypothesis.effects, c), c.starts, step, across, here), free
    )
    return sorted(scored, key=lambda score: -score.gain)


def score_in_place(
    bench: Workbench, hypothesis: Hypothesis, effect: Candidate, wider: Candidate, step: float
) -> Score:
    """Score what contains one of a model's effects in that effect's place; what both have stays as it was fitted."""
    carried = wider.taken_over(effect, hypothesis.values)
    starts = different([{**start, **carried} for start in wider.starts])
    effects = (*hypothesis.without(effect), wider)
    return _score(
        bench, hypothesis, effects, starts, step, Across(hypothesis.fit), _left_by(bench, hypothesis, step)
    )


def _left_by(bench: Workbench, hypothesis: Hypothesis, step: float) -> np.ndarray:
    """What a model leaves of the training data and of its prior. # (values + parameters,)."""
    return np.concatenate([bench.residuals(hypothesis, bench.training, step), hypothesis.fit.off_prior])


def _score(
    bench: Workbench,
    hypothesis: Hypothesis,
    effects: tuple[Candidate, ...],
    starts: Sequence[dict[str, float]],
    step: float,
    across: Across,
    here: np.ndarray,
) -> Score:
    """Score the last one of these effects from each start, against what the hypothesis leaves."""
    bench.alive()
    candidate = effects[-1]
    problem = bench.problem(effects, step)
    left = across(here)
    best_gain, best_left = 0.0, float("inf")
    best_change = np.zeros_like(left)
    start = starts[0]
    weakens = candidate.effect.weakens
    visible = 0.0 if weakens else float("inf")
    gain_at = dict.fromkeys((tuple(begin[free.path] for free in candidate.moments) for begin in starts), 0.0)
    for begin in starts:
        for shrink in SHRUNK:
            size = begin[candidate.size_path] * (1.0 / shrink if weakens else shrink)
            tried = {**begin, candidate.size_path: size}
            if not _inside(candidate, tried):
                continue
            moved = problem.residuals(problem.parameters.unit({**hypothesis.values, **tried}))
            # parameters of the effect have no prior, and those of the model have not moved
            change = np.concatenate([moved, hypothesis.fit.off_prior]) - here
            e = across(change)
            power = float(e @ e)
            if power <= 0.0:
                continue
            gain = gain_of(e, left)
            at = tuple(begin[free.path] for free in candidate.moments)
            gain_at[at] = max(gain_at[at], gain)
            remaining = float(np.sum((left + e) ** 2))
            if remaining < best_left:
                best_left, start = remaining, tried
            if gain > best_gain:
                best_gain, best_change = gain, e
            if shrink < ESTIMATING:
                continue
            root = (VISIBLE / power) ** 0.5
            visible = max(visible, size / root) if weakens else min(visible, abs(size) * root)
    bench.evaluations += problem.evaluations
    paths = [free.path for free in candidate.moments]
    ordered = sorted(gain_at, key=lambda at: -gain_at[at]) if paths else []
    moments = tuple(dict(zip(paths, at, strict=True)) for at in ordered)
    return Score(candidate, best_gain, start, moments, best_left, visible, best_change, left)


def gain_of(change: np.ndarray, rest: np.ndarray) -> float:
    """Fall of the squared residuals if a change takes its best positive multiple; of one that diverged nothing.

    Args:
        change: of the residuals, across the fitted parameters' columns. # (values,)
        rest: what the model leaves, across these columns. # (values,)
    """
    if not np.isfinite(change).all():
        return 0.0
    power, along = float(change @ change), -float(change @ rest)
    return along * along / power if along > 0.0 and power > 0.0 else 0.0


def gain_of_pair(first: Score, second: Score) -> float:
    """Fall of the squared residuals if two effects, held against the same model, took their best multiples at once."""
    left = nnls(np.stack([first.change, second.change], axis=1), -first.rest)[1]
    return float(first.rest @ first.rest) - float(left) ** 2


def _inside(candidate: Candidate, values: dict[str, float]) -> bool:
    return all(free.lower <= values[free.path] <= free.upper for free in candidate.free)
