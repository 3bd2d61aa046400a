"""Variance-based sensitivity: Sobol indices of a signal, segment by segment.

The first-order index of a parameter is the part of the output's variance that it alone explains, the total index that
in which it has a share; their difference is what it does together with others (Saltelli et al., Computer Physics
Communications 181, 2010). For a signal, numerators and variances are summed over the samples (Lamboni, Monod, Makowski,
Reliability Engineering and System Safety 96, 2011). The sample is scipy's.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import sobol_indices, uniform

from hydrolek_drake.identification.objective.norms import segment_edges
from hydrolek_drake.identification.sensitivity.points import check_points

MOST_SAMPLES = 400
"""Of the signal that are kept: neighbours say the same."""

RESAMPLES = 200
"""Of the bootstrap."""


AT_ONCE = 64
"""Evaluations that are asked for at once: some tables of lanes, and little memory."""


@dataclass(frozen=True)
class SobolIndices:
    """Indices per segment, and over all segments.

    Attributes:
        first: # (parameters, segments)
        total: # (parameters, segments)
        first_whole: # (parameters,)
        total_whole: # (parameters,)
        total_low: lower ends of the 95 % intervals of `total_whole`, from the bootstrap. # (parameters,)
        total_high: # (parameters,)
        points: N; the cost is N (parameters + 2) evaluations.
        diverged: evaluations without a value somewhere, where the output in the middle of the ranges was taken.
    """

    first: np.ndarray
    total: np.ndarray
    first_whole: np.ndarray
    total_whole: np.ndarray
    total_low: np.ndarray
    total_high: np.ndarray
    points: int
    diverged: int


def sobol_of(
    outputs: Callable[[Sequence[np.ndarray]], Sequence[np.ndarray]],
    segments: int,
    parameters: int,
    points: int,
    rng: np.random.Generator,
    progress: Callable[[int], None] = lambda done: None,
) -> SobolIndices:
    """First-order and total indices of an output that may be a whole signal, parameters uniform in the cube.

    Args:
        outputs: places in the unit cube -> signal at each, NaN where it has no value. # (n,)
        segments: equal parts of the signal.
        parameters: how many.
        points: N, a power of two.
        rng: of the sample and the bootstrap.
        progress: told now and then how many evaluations are done.

    Raises:
        InputError: not a power of two.
    """
    check_points(points)
    middle = np.nan_to_num(np.asarray(outputs([np.full(parameters, 0.5)])[0], dtype=float))
    every = max(-(-middle.size // MOST_SAMPLES), 1)
    kept = middle[::every]
    done, diverged = 0, 0
    seen: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []

    def signals(columns: np.ndarray) -> np.ndarray:
        nonlocal done, diverged
        rows = []
        for begin in range(0, columns.shape[1], AT_ONCE):
            for whole in outputs(list(columns.T[begin : begin + AT_ONCE])):
                signal = np.asarray(whole, dtype=float)[::every]
                missing = ~np.isfinite(signal)
                diverged += bool(missing.any())
                rows.append(np.where(missing, kept, signal))
                done += 1
            progress(done)
        return np.array(rows).T

    edges = segment_edges(kept.size, segments)

    def summed(f_A: np.ndarray, f_B: np.ndarray, f_AB: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices of each segment and of the whole. # (segments + 1, parameters) each."""
        if not seen:
            seen.append((f_A, f_B, f_AB))
        variance = _parts(np.var([f_A, f_B], axis=(0, -1))[None], edges)
        first = _parts(np.mean(f_B * (f_AB - f_A), axis=-1), edges)
        total = _parts(0.5 * np.mean((f_A - f_AB) ** 2, axis=-1), edges)
        safe = np.where(variance > 0.0, variance, np.inf)  # a part that never changes has no indices: zero
        return (first / safe).T, (total / safe).T

    found = sobol_indices(func=signals, n=points, dists=[uniform()] * parameters, method=summed, rng=rng)
    first, total = (
        np.reshape(value, (segments + 1, parameters)).T for value in (found.first_order, found.total_order)
    )
    f_A, f_B, f_AB = seen[0]
    drawn = [
        summed(f_A[:, i], f_B[:, i], f_AB[..., i])[1][-1]
        for i in rng.integers(points, size=(RESAMPLES, points))
    ]
    low, high = np.quantile(drawn, [0.025, 0.975], axis=0)
    return SobolIndices(first[:, :-1], total[:, :-1], first[:, -1], total[:, -1], low, high, points, diverged)


def _parts(values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Sums over each segment, and over all, along the last axis. # (k, n) -> (k, segments + 1)."""
    parts = [values[:, a:b].sum(axis=1) for a, b in pairwise(edges)]
    return np.stack([*parts, values.sum(axis=1)], axis=1)
