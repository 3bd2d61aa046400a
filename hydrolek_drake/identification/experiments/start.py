"""Where a joint rests when a recording begins: a mean of noisy readings, and what its error does to the residuals."""

import numpy as np

STANDS_STILL = 3.0
"""The means of two halves of the leading samples differ by less than so many of their standard errors."""

MOST_OFF = 3.0
"""So many standard deviations the start may be off: one in four hundred is more."""


def resting_position(position: np.ndarray, command: np.ndarray, noise: float) -> tuple[float, float]:
    """Mean of the leading samples while the command has not changed yet and the joint stands still, and its error.

    The halves of these samples may differ by a slow movement that scatter hides: so far the first sample may be from
    the mean.
    """
    changed = np.flatnonzero(command != command[0])
    leading = position[: max(int(changed[0]) if changed.size else position.size, 1)]
    finite = leading[np.isfinite(leading)]
    if not finite.size:
        finite = position[np.isfinite(position)][:1]
    while finite.size >= 4 and not _still(finite):
        finite = finite[: finite.size // 2]
    crept = 0.0
    if finite.size >= 4:
        first, second = np.array_split(finite, 2)
        crept = float(second.mean() - first.mean())
    return float(finite.mean()), float(np.hypot(noise / np.sqrt(finite.size), crept))


def without_offset(residual: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """(I + a a')^(-1/2) r for what an offset of one standard deviation does, a. # (n,).

    That takes out the likeliest offset, a'r / (1 + a'a). Where it would be `MOST_OFF` or more something else is wrong,
    and so much is taken out and no more: a model far from the noise is not to be excused by its start.
    """
    square = float(offset @ offset)
    if square == 0.0:
        return residual
    likeliest = float(offset @ residual) / (1.0 + square)
    share = (1.0 - 1.0 / np.sqrt(1.0 + square)) * (1.0 + square) / square
    return residual - share * min(max(likeliest, -MOST_OFF), MOST_OFF) * offset


def _still(values: np.ndarray) -> bool:
    """Whether the halves of some samples have one mean, as far as their scatter tells."""
    first, second = np.array_split(values, 2)
    error = np.sqrt(first.var(ddof=1) / first.size + second.var(ddof=1) / second.size)
    return abs(float(first.mean() - second.mean())) <= STANDS_STILL * error
