"""DataFrames of pandas; pandas itself is not loaded: who has a DataFrame has done so."""

import sys
from typing import Any

import numpy as np

from hydrolek_drake.recordings.clock import seconds_of
from hydrolek_drake.recordings.columns import TIME
from hydrolek_drake.recordings.table import Column, Table


def is_frame(given: object) -> bool:
    """Whether this is a DataFrame of pandas."""
    pandas = sys.modules.get("pandas")
    return pandas is not None and isinstance(given, pandas.DataFrame)


def read_frame(frame: Any) -> Table:
    """Columns of a DataFrame, and its index where that is no mere count of rows.

    An index of times or durations is `time_s`, and so is one of floats without a name; a numeric one with a
    name is a column of that name. Columns of several levels are `level.level`.
    """
    columns = []
    for place, label in enumerate(frame.columns):
        name, values = _joined(label), _array(frame.iloc[:, place])
        columns.append(Column((name, f"{name}_s") if values.dtype.kind in "mM" else (name,), _plain(values)))
    index = frame.index
    if index.nlevels == 1 and type(index).__name__ != "RangeIndex":
        values, names = _array(index.to_series()), (str(index.name),) if index.name is not None else ()
        if values.dtype.kind in "mM" or (values.dtype.kind == "f" and not names):
            columns.insert(0, Column((f"{TIME}_s", *names), _plain(values)))
        elif values.dtype.kind in "fiu" and names:
            columns.insert(0, Column(names, values))
    return Table(tuple(columns))


def _array(series: Any) -> np.ndarray:
    """Values of a column; of times with a zone those of Greenwich."""
    return (series.dt.tz_convert(None) if getattr(series.dtype, "tz", None) else series).to_numpy()


def _joined(label: Any) -> str:
    return ".".join(str(part) for part in label) if isinstance(label, tuple) else str(label)


def _plain(values: np.ndarray) -> np.ndarray:
    """Numbers as they are, times in seconds, all else as text cells with None where nothing is."""
    if values.dtype.kind in "mM":
        return seconds_of(values)
    if values.dtype.kind in "fiub":
        return values
    pandas = sys.modules["pandas"]
    return np.array([None if pandas.isna(cell) is True else cell for cell in values], dtype=object)
