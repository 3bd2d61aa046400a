"""The time axis: order, duplicates, gaps, jitter."""

from collections.abc import Callable

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.finding import Finding

GAP_INTERVALS = 3.0
"""An interval longer than this many usual (median) ones is a gap."""

JITTER_FRACTION = 0.1
"""An interval that is off the usual one by more than this fraction is jitter."""


def ordered(time: np.ndarray, what: str, row: Callable[[int], str]) -> tuple[np.ndarray, Finding | None]:
    """Check that time never runs backwards and find repeated time stamps.

    Args:
        time: Recorded time [s]. # (n,)
        what: File and column, for messages.
        row: Names the sample with a given index, for messages.

    Returns:
        Which samples to keep (the first of each time stamp) # (n,), and a finding if any are dropped.

    Raises:
        InputError: A time is NaN or infinite, or earlier than the one before.
    """
    bad = np.flatnonzero(~np.isfinite(time))
    if bad.size:
        raise InputError(f"{what} is {time[bad[0]]} in {row(int(bad[0]))}; every row needs a finite time")
    steps = np.diff(time)
    back = np.flatnonzero(steps < 0)
    if back.size:
        i = int(back[0])
        raise InputError(
            f"{what} runs backwards in {row(i + 1)}, from {time[i]:.9g} s to {time[i + 1]:.9g} s; "
            "cut the recording there or repair the clock"
        )
    keep = np.concatenate([[True], steps > 0]) if time.size else np.zeros(0, dtype=bool)
    repeated = time[~keep]
    if not repeated.size:
        return keep, None
    message = (
        f"{repeated.size} samples repeat the time stamp before them and are dropped, "
        f"first at {repeated[0]:.9g} s"
    )
    return keep, Finding("duplicate", None, message, tuple((float(t), float(t)) for t in np.unique(repeated)))


def seconds_of(nanoseconds: np.ndarray) -> np.ndarray:
    """Time stamps or durations of NumPy in seconds (stamps since 1970), NaN where there is none.

    Whole seconds and the rest are converted apart: a stamp in nanoseconds has more digits than a double.
    """
    exact = nanoseconds.astype(f"{nanoseconds.dtype.kind}8[ns]")
    whole, rest = np.divmod(exact.astype("i8"), 1_000_000_000)
    return np.where(np.isnat(exact), np.nan, whole + rest / 1e9)


def usual_interval(time: np.ndarray) -> float:
    """Median sample interval [s] of strictly increasing time with at least two samples."""
    return float(np.median(np.diff(time)))


def gap_follows(time: np.ndarray) -> np.ndarray:
    """Whether a gap follows each sample, for all but the last one."""
    if time.size < 2:
        return np.zeros(0, dtype=bool)
    return np.diff(time) > GAP_INTERVALS * usual_interval(time)


def cut_off(time: np.ndarray) -> Finding:
    """The finding that a file was not finished, so that samples after the last one are missing."""
    end = float(time[-1])
    message = (
        f"the file breaks off after {end:.9g} s: its recorder was not stopped properly, samples are missing"
    )
    return Finding("gap", None, message, ((end, end),))


def clock_findings(time: np.ndarray) -> list[Finding]:
    """Gaps and jitter of a strictly increasing time axis [s] with at least two samples."""
    steps = np.diff(time)
    usual = usual_interval(time)
    gaps = gap_follows(time)
    found = []
    if gaps.any():
        message = (
            f"{int(gaps.sum())} gaps of more than {GAP_INTERVALS:g} usual intervals of {usual:.6g} s, "
            f"the longest {steps.max():.6g} s: samples are missing or the clock jumped"
        )
        found.append(Finding("gap", None, message, spans_of(gaps, time, intervals=True)))
    jitter = ~gaps & (np.abs(steps - usual) > JITTER_FRACTION * usual)
    if jitter.any():
        odd = steps[jitter]
        message = (
            f"{odd.size} of {steps.size} sample intervals are off the usual {usual:.6g} s by more than "
            f"{JITTER_FRACTION:.0%} ({odd.min():.6g} s to {odd.max():.6g} s)"
        )
        found.append(Finding("clock", None, message, spans_of(jitter, time, intervals=True)))
    return found


def runs_of(mask: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """First and last index of every run of true values in `mask`."""
    edges = np.diff(np.concatenate([[0], mask.astype(np.int8), [0]]))
    return np.flatnonzero(edges == 1), np.flatnonzero(edges == -1) - 1


def spans_of(
    mask: np.ndarray, time: np.ndarray, *, intervals: bool = False
) -> tuple[tuple[float, float], ...]:
    """Time spans [s] of the runs of true values; with `intervals`, element i of `mask` is from i to i + 1."""
    first, last = runs_of(mask)
    return tuple((float(time[a]), float(time[b + int(intervals)])) for a, b in zip(first, last, strict=True))
