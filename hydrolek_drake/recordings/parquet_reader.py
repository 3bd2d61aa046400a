"""Apache Parquet files."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.recordings.table import Column, Table

if TYPE_CHECKING:
    import pyarrow


def read_parquet(path: Path) -> Table:
    """Read every column of a Parquet file; nulls are NaN, time stamps are seconds since 1970."""
    import pyarrow.parquet

    with pyarrow.parquet.ParquetFile(path) as file:
        table = file.read()
    return Table(
        tuple(
            _column(name, values)
            for name, values in zip(table.column_names, table.itercolumns(), strict=True)
        )
    )


def _column(name: str, values: "pyarrow.ChunkedArray") -> Column:
    import pyarrow

    kind = values.type
    if pyarrow.types.is_timestamp(kind) or pyarrow.types.is_duration(kind):
        return Column((name, f"{name}_s"), _seconds(values.to_numpy()))
    if pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind) or pyarrow.types.is_boolean(kind):
        return Column((name,), values.cast("float64").to_numpy())
    return Column((name,), np.array(values.to_pylist(), dtype=object))


def _seconds(stamps: np.ndarray) -> np.ndarray:
    """Time stamps (since 1970) or durations in seconds; missing ones are NaN."""
    nanoseconds = stamps.astype(f"{stamps.dtype.kind}8[ns]")
    return np.where(np.isnat(nanoseconds), np.nan, nanoseconds.astype("i8") / 1e9)
