"""What is wrong (refused) or noteworthy (reported) about the values of a column."""

from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.clock import runs_of, spans_of
from hydrolek_drake.recordings.columns import HELD_QUANTITIES, quantity_of
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.table import Column, Table

SATURATED_SAMPLES = 5
"""Fewest equal samples at an extreme value that count as saturated; noise repeats a value less often."""

PLATEAU_RATIO = 3
"""A saturated stretch is this many times longer than any plateau between the extremes.

A coarsely quantised channel repeats values everywhere; a saturated one does so only at its limit.
"""

ENTRY_STEP = 0.2
"""Least step with which a signal runs into its limit, as a fraction of its usual (median) step in motion.

A signal that comes to rest by itself slows down before; one that is cut off does not.
"""


def numbers(column: Column, table: Table, path: Path) -> np.ndarray:
    """The values of a column as floats; empty cells are NaN.

    Raises:
        InputError: A cell is not a number.
    """
    values = column.values
    if values.dtype.kind in "fiub":
        return values.astype(float)
    result = np.empty(len(values))
    comma = table.decimal_comma
    for index, cell in enumerate(values.tolist()):
        try:
            result[index] = _number(cell, comma)
        except (TypeError, ValueError, OverflowError):
            shown = repr(cell if len(str(cell)) <= 40 else f"{str(cell)[:40]}...")
            raise InputError(
                f"{path}: column {column.name!r} has {shown} in {table.row(index)}; "
                "write a number or leave it empty"
            ) from None
    return result


def _number(cell: Any, decimal_comma: bool) -> float:
    if cell is None:
        return np.nan
    if not isinstance(cell, str):
        return float(cell)
    text = cell.strip()
    if not text:
        return np.nan
    if "_" in text:  # Python reads 1_000 as a number; no measuring program writes that
        raise ValueError(cell)
    return float(text.replace(",", ".", 1) if decimal_comma else text)


def signal_findings(time: np.ndarray, key: str, values: np.ndarray, unit: str) -> list[Finding]:
    """NaN stretches, constancy and saturation of one signal.

    Args:
        time: Strictly increasing [s]. # (n,)
        key: `<joint>.<quantity>`.
        values: In SI units, with at least one that is not NaN. # (n,)
        unit: SI unit, for the message.
    """
    found = []
    missing = np.isnan(values)
    if missing.any():
        spans = spans_of(missing, time)
        count = int(missing.sum())
        message = (
            f"{key} has no value in {count} of {values.size} samples ({count / values.size:.2g} of all), "
            f"in {len(spans)} stretches, first at {spans[0][0]:.9g} s"
        )
        found.append(Finding("nan", key, message, spans))
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    if low == high:
        message = f"{key} is constant at {low:.6g} {unit}"
        found.append(Finding("constant", key, message, ((float(time[0]), float(time[-1])),)))
    elif quantity_of(key) not in HELD_QUANTITIES:
        for word, extreme in (("smallest", low), ("largest", high)):
            spans = _saturated(time, values, extreme)
            if spans:
                total = sum(end - start for start, end in spans)
                message = (
                    f"{key} sits exactly at its {word} value {extreme:.6g} {unit} in {len(spans)} stretches, "
                    f"together {total:.4g} s, but moves otherwise: the sensor may be at its limit, or the "
                    "joint at a stop"
                )
                found.append(Finding("saturated", key, message, spans))
    return found


def _saturated(time: np.ndarray, values: np.ndarray, extreme: float) -> tuple[tuple[float, float], ...]:
    """Spans in which a moving signal is cut off at an extreme value.

    A stretch from the very first sample counts only if the signal is cut off there again later: alone it is
    just the rest before the motion.
    """
    first, last = runs_of(values == extreme)
    steps = np.abs(np.diff(values))
    moving = steps[steps > 0]
    if not moving.size:  # no two neighbouring samples that differ
        return ()
    elsewhere = (steps == 0) & (values[:-1] != np.nanmin(values)) & (values[:-1] != np.nanmax(values))
    plateau_first, plateau_last = runs_of(elsewhere)
    plateau = int((plateau_last - plateau_first).max(initial=-1)) + 2  # samples, not steps
    least = max(SATURATED_SAMPLES, PLATEAU_RATIO * plateau)
    long = last - first + 1 >= least
    # The step into the limit is itself cut short, so the one before it may count instead.
    entry = np.array([np.nanmax(steps[max(i - 2, 0) : i], initial=0.0) for i in first])
    cut_off = long & (first > 0) & (entry >= ENTRY_STEP * np.median(moving))
    if not cut_off.any():
        return ()
    cut_off |= long & (first == 0)
    return tuple((float(time[a]), float(time[b])) for a, b in zip(first[cut_off], last[cut_off], strict=True))
