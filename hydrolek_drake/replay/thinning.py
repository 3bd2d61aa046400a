"""Fewer points for a plot, with every peak kept."""

import numpy as np

PLOTTED_POINTS = 4000
"""More than a screen has columns, so nothing is seen to be missing."""


def thinned(
    time: np.ndarray, values: np.ndarray, points: int = PLOTTED_POINTS
) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest value of each of `points` / 2 groups of neighbours, in their order.

    Args:
        time: [s]. # (n,)
        values: NaN stays NaN where a whole group is. # (n,)
        points: at most this many are left (a few more for gaps).
    """
    if time.size <= points:
        return time, values
    size = -(-time.size // (points // 2))
    starts = np.arange(0, time.size, size)
    low = np.where(np.isnan(values), np.inf, values)
    high = np.where(np.isnan(values), -np.inf, values)
    kept = []
    for start in starts.tolist():
        group = slice(start, start + size)
        kept += sorted({start + int(low[group].argmin()), start + int(high[group].argmax())})
    return time[kept], values[kept]
