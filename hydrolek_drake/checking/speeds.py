"""Speeds of measured motion, and how alike two signals are."""

import numpy as np


def speed_of(times: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Speed over a tenth of a second, which noise does not drown."""
    width = max(round(0.1 / float(np.median(np.diff(times)))), 1)
    if position.size <= 2 * width:
        width = 1
    return (position[width:] - position[:-width]) / (times[width:] - times[:-width])


def correlation(a: np.ndarray, b: np.ndarray) -> float:
    """Pearson's correlation of two signals where both have values; 0 where one does not vary."""
    good = np.isfinite(a) & np.isfinite(b)
    if good.sum() < 3 or np.ptp(a[good]) == 0.0 or np.ptp(b[good]) == 0.0:
        return 0.0
    return float(np.corrcoef(a[good], b[good])[0, 1])
