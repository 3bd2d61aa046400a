"""Writing signals to CSV and Parquet, with units in the column names."""

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.columns import column_name, default_unit
from hydrolek_drake.recordings.recording import Recording

if TYPE_CHECKING:
    import pyarrow


def write_recording(recording: Recording, path: str | Path) -> Path:
    """Write a recording to CSV or Parquet, as the extension says; `read_recording` gives the same numbers.

    Returns:
        The path.

    Raises:
        InputError: See `write_signals`.
    """
    return write_signals(path, recording.time, recording.signals, recording.units)


def write_signals(
    path: str | Path,
    time: np.ndarray,
    signals: Mapping[str, np.ndarray],
    units: Mapping[str, str] | None = None,
) -> Path:
    """Write signals over time to CSV or Parquet, as the extension says.

    The file appears only when it is complete; an older one of that name is replaced then.

    Args:
        path: `.csv` or `.parquet` file in a folder that exists.
        time: [s]. # (n,)
        signals: By `<joint>.<quantity>`, in SI units; NaN becomes an empty cell. # (n,) each
        units: SI unit by signal; needed only for quantities other than those of recordings.

    Returns:
        The path.

    Raises:
        InputError: The extension is another one, a signal has no unit or another length than time, or the
            file cannot be written.
    """
    import pyarrow

    path = Path(path)
    writers: dict[str, Callable[[pyarrow.Table, Path], None]] = {
        ".csv": _write_csv,
        ".parquet": _write_parquet,
    }
    write = writers.get(path.suffix.lower())
    if write is None:
        raise InputError(f"cannot write {path}; use the extension {' or '.join(writers)}")
    columns = {"time_s": np.asarray(time, dtype=float)}
    for key, values in signals.items():
        unit = (units or {}).get(key) or default_unit(key)
        if unit is None:
            raise InputError(f"cannot write {path}: signal {key} has no unit")
        values = np.asarray(values, dtype=float)
        if values.shape != columns["time_s"].shape:
            raise InputError(
                f"cannot write {path}: signal {key} has shape {values.shape}; "
                f"time has {columns['time_s'].shape}"
            )
        columns[column_name(key, unit)] = values
    table = pyarrow.table({name: pyarrow.array(values, from_pandas=True) for name, values in columns.items()})

    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(table, part)
        os.replace(part, path)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from None
    finally:
        part.unlink(missing_ok=True)
    return path


def _write_csv(table: "pyarrow.Table", path: Path) -> None:
    from pyarrow import csv

    with path.open("wb") as stream:
        stream.write((",".join(table.column_names) + "\n").encode())
        csv.write_csv(table, stream, csv.WriteOptions(include_header=False))


def _write_parquet(table: "pyarrow.Table", path: Path) -> None:
    from pyarrow import parquet

    parquet.write_table(table, path)
