"""How noisy a recorded signal is, from itself, and smoothing that passes over gaps."""

import math

import numpy as np

_ORDER = 3
"""Third differences: whatever moves like a parabola over four samples drops out."""

_GAIN = math.sqrt(math.comb(2 * _ORDER, _ORDER))
"""White noise of deviation 1 has third differences of deviation sqrt(1 + 9 + 9 + 1)."""

_MAD_TO_DEVIATION = 1.4826
_KEPT = 3.5
"""Differences beyond this many deviations belong to the signal (jumps, knocks), not to its noise."""


def noise_level(values: np.ndarray) -> float:
    """Standard deviation of the white noise on a slowly varying signal, from the signal alone.

    The median absolute third difference gives a first deviation which jumps do not disturb; the second
    moment of the differences within 3.5 of these refines it, since the median itself moves in steps when the
    signal is quantised. The result is at least the deviation of rounding to the signal's smallest step,
    step / sqrt(12), which a signal that stands still does not show. NaNs are left out.

    Args:
        values: one sample for each time. # (n,)

    Returns:
        The deviation in the unit of the values; 0 for fewer than five samples in a row or a constant.
    """
    steps = np.abs(np.diff(values))
    steps = steps[np.isfinite(steps) & (steps > 0.0)]
    differences = np.diff(values, n=_ORDER)
    differences = differences[np.isfinite(differences)]
    if not steps.size or differences.size < 2:
        return 0.0
    rounding = float(steps.min()) / math.sqrt(12.0)
    first = _MAD_TO_DEVIATION * float(np.median(np.abs(differences)))
    kept = differences[np.abs(differences) <= _KEPT * first]
    white = math.sqrt(float(np.mean(kept**2))) / _GAIN
    return max(white, rounding)


def smoothed(values: np.ndarray, samples: int) -> np.ndarray:
    """Mean of the finite values among `samples` neighbours, an odd number.

    Args:
        values: where one is NaN, so is the result. # (n,)
        samples: width of the window; less at both ends.
    """
    finite = np.isfinite(values)
    window = np.ones(min(samples, values.size))
    total = np.convolve(np.where(finite, values, 0.0), window, mode="same")
    count = np.convolve(finite.astype(float), window, mode="same")
    return np.where(finite, total / np.maximum(count, 1.0), np.nan)


def samples_in(seconds: float, time: np.ndarray) -> int:
    """Odd number of samples, at least 3, that span about `seconds` of a recording's times."""
    return max(2 * round(0.5 * seconds / float(np.median(np.diff(time)))) + 1, 3)
