"""Writing signals to CSV and Parquet, with units in the column names."""

import csv
import io
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import being_written, disarmed
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
        InputError: The extension is another one, a signal has no unit or another length than time, its name is no
            name for a column, or the file cannot be written.
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
        if not key.isprintable() or disarmed(key) != key:
            raise InputError(
                f"cannot write {path}: signal '{key}' begins with a sign that a spreadsheet takes for a formula, or "
                "holds control characters; rename it"
            )
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

    try:
        with being_written(path) as part:
            write(table, part)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from None
    return path


def _write_csv(table: "pyarrow.Table", path: Path) -> None:
    from pyarrow import csv as arrow_csv

    header = io.StringIO()
    csv.writer(header, lineterminator="\n").writerow(table.column_names)
    with path.open("wb") as stream:
        stream.write(header.getvalue().encode())
        arrow_csv.write_csv(table, stream, arrow_csv.WriteOptions(include_header=False))


def _write_parquet(table: "pyarrow.Table", path: Path) -> None:
    from pyarrow import parquet

    parquet.write_table(table, path)
