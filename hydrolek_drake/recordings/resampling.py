"""Values of a recorded signal at other times than it was sampled."""

import numpy as np

from hydrolek_drake.recordings.clock import gap_follows


def held(time: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Sample and hold: the last value set at or before each time; NaN before the first.

    Args:
        time: Strictly increasing sample times [s]. # (n,)
        values: Samples. # (n,)
        at: Wanted times [s]. # (m,)

    Returns:
        Held values. # (m,)
    """
    index = np.searchsorted(time, at, side="right") - 1
    return np.where(index >= 0, values[np.maximum(index, 0)], np.nan)


def linear(time: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Straight line between neighbouring samples; NaN outside the record and inside gaps.

    Nothing was measured in a gap, so a line across it would be invented. A NaN sample spoils only what lies
    strictly between it and its neighbours.

    Args:
        time: Strictly increasing sample times [s]. # (n,)
        values: Samples. # (n,)
        at: Wanted times [s]. # (m,)

    Returns:
        Interpolated values. # (m,)
    """
    left = np.clip(np.searchsorted(time, at, side="right") - 1, 0, time.size - 1)
    right = np.minimum(left + 1, time.size - 1)
    on_sample = time[left] == at
    width = np.where(right > left, time[right] - time[left], 1.0)
    weight = (at - time[left]) / width
    between = values[left] * (1.0 - weight) + values[right] * weight
    measured = (at >= time[0]) & (at <= time[-1]) & ~np.append(gap_follows(time), False)[left]
    return np.where(on_sample, values[left], np.where(measured, between, np.nan))


def averaged_held(time: np.ndarray, values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Mean over time of what is held between its samples; NaN where it is not known throughout.

    Args:
        time: Strictly increasing sample times [s]. # (n,)
        values: Samples, each held until the next, the last for good. # (n,)
        edges: Strictly increasing times [s]. # (m + 1,)

    Returns:
        Means. # (m,)
    """
    knots = np.append(time, max(edges[-1], time[-1]) + 1.0)
    lasts, known = np.diff(knots), np.isfinite(values)
    area = np.concatenate([[0.0], np.cumsum(np.where(known, values, 0.0) * lasts)])
    unknown = np.concatenate([[0.0], np.cumsum(np.where(known, 0.0, lasts))])
    mean = np.diff(np.interp(edges, knots, area)) / np.diff(edges)
    lost = np.diff(np.interp(edges, knots, unknown)) > 0.0
    return np.where(lost | (edges[:-1] < time[0]), np.nan, mean)


def averaged(time: np.ndarray, values: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Mean of the samples between each two neighbouring times; NaN where there is none with a value.

    Args:
        time: Strictly increasing sample times [s]. # (n,)
        values: Samples. # (n,)
        edges: Strictly increasing times [s]; a sample at an edge belongs to what follows it. # (m + 1,)

    Returns:
        Means. # (m,)
    """
    good = np.isfinite(values)
    first = np.searchsorted(time[good], edges, side="left")
    sums = np.concatenate([[0.0], np.cumsum(values[good])])
    count = np.diff(first)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(count > 0, np.diff(sums[first]) / count, np.nan)
