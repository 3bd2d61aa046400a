"""How noisy a recorded signal is, from itself, and smoothing that passes over gaps."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

_ORDER = 3
"""Third differences: whatever moves like a parabola over four samples drops out."""

_GAIN = math.sqrt(math.comb(2 * _ORDER, _ORDER))
"""White noise of deviation 1 has third differences of deviation sqrt(1 + 9 + 9 + 1)."""

_MAD_TO_DEVIATION = 1.4826
_KEPT = 3.5
"""Differences beyond this many deviations belong to the signal (jumps, knocks), not to its noise."""

_WINDOW = 40
_LOW = 0.1
"""Noise is the same everywhere: where it seems larger, the signal moves. So the share of the windows that move least
tells it, if that differs from the whole by more than ..."""

_DEVIATIONS = 3.0
"""... so many standard deviations of what such a share tells of white noise."""


def noise_level(values: np.ndarray) -> float:
    """Standard deviation of the white noise on a slowly varying signal, from the signal alone.

    The median absolute third difference gives a first deviation which jumps do not disturb; the second
    moment of the differences within 3.5 of these refines it, since the median itself moves in steps when the
    signal is quantised. The result is at least the deviation of rounding to the signal's smallest step,
    step / sqrt(12), which a signal that stands still does not show. NaNs are left out.
    A joint that sticks and slips moves as fast as noise does, but not always: see `_LOW`.

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
    windows = np.array_split(differences, max(differences.size // _WINDOW, 1))
    # a rounded signal that stands still is silent
    moving = [w for w in windows if np.count_nonzero(w) > w.size // 2]
    if not moving:
        return rounding
    differences = np.concatenate(moving)
    first = _MAD_TO_DEVIATION * float(np.median(np.abs(differences)))
    kept = differences[np.abs(differences) <= _KEPT * first]
    white = math.sqrt(float(np.mean(kept**2))) / _GAIN
    quiet, error = _where_it_moves_least(moving)
    if white > (1.0 + _DEVIATIONS * error) * quiet:
        white = quiet
    return max(white, rounding)


def _where_it_moves_least(windows: Sequence[np.ndarray]) -> tuple[float, float]:
    """Deviation of white noise by the windows in which its differences are smallest, and the relative error of that.

    The variance of a window is distributed as chi squared over its degrees of freedom, fewer than its samples since
    differences that overlap are correlated; so is then its quantile at `_LOW`.
    """
    if len(windows) * _LOW < 1.0:
        return math.inf, 0.0
    variances = [float(np.mean(w**2)) for w in windows]
    alike = [math.comb(2 * _ORDER, _ORDER + k) / _GAIN**2 for k in range(1, _ORDER + 1)]
    freedom = _WINDOW / (1.0 + 2.0 * sum(c * c for c in alike))
    expected = float(chi2.ppf(_LOW, freedom)) / freedom
    density = float(chi2.pdf(expected * freedom, freedom)) * freedom
    spread = math.sqrt(_LOW * (1.0 - _LOW) / len(windows)) / density
    quiet = math.sqrt(float(np.quantile(variances, _LOW)) / expected) / _GAIN
    return quiet, 0.5 * spread / expected


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
