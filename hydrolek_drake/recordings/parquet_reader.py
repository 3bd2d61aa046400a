"""Apache Parquet files."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.recordings.clock import seconds_of
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
        return Column((name, f"{name}_s"), seconds_of(values.to_numpy()))
    if pyarrow.types.is_integer(kind) or pyarrow.types.is_floating(kind) or pyarrow.types.is_boolean(kind):
        return Column((name,), values.cast("float64").to_numpy())
    return Column((name,), np.array(values.to_pylist(), dtype=object))
