"""Variables of a MATLAB file: of version 5 to 7 by SciPy, and where there are tables or timetables by mat-io."""

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.recordings.apart.found import Asked, Found, names_with_unit
from hydrolek_drake.recordings.clock import seconds_of

_OBJECTS = "objects"


def load(asked: Asked) -> None:
    """Load the package that reads."""
    if asked.options[_OBJECTS]:
        import matio  # noqa: F401
    else:
        import scipy.io  # noqa: F401


def read(path: Path, asked: Asked) -> Iterator[Found]:
    """Every variable that is a row or a column; fields of structs and columns of tables as `struct.field`.

    Where `asked.options` has "objects", mat-io reads the file, which knows MATLAB's tables.
    """
    warnings.simplefilter("ignore")
    content = _by_mat_io(path) if asked.options[_OBJECTS] else _by_scipy(path)
    variables = {name: value for name, value in content.items() if not name.startswith("__")}
    for name, values, unit in _flattened(variables):
        if is_column(values):
            yield Found(names_with_unit(tuple(ends(name)), unit), values.ravel(), name.rpartition(".")[0])


def _by_scipy(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    return loadmat(path, simplify_cells=True)


def _by_mat_io(path: Path) -> dict[str, Any]:
    import matio

    return matio.load_from_mat(str(path), add_table_attrs=True)


def ends(name: str) -> Iterator[str]:
    """A name and its ends: `log.joint.angle_deg`, `joint.angle_deg`, `angle_deg`."""
    parts = name.split(".")
    for start in range(len(parts)):
        yield ".".join(parts[start:])


def is_column(values: Any) -> bool:
    """Whether an array is n, n x 1 or 1 x n with more than one element (one element is a parameter)."""
    return values.ndim in (1, 2) and max(values.shape) > 1 and (values.ndim == 1 or min(values.shape) == 1)


def _flattened(struct: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, np.ndarray, str]]:
    """Name, values and unit (if stated) of every variable, those of structs and tables apart."""
    for name, value in struct.items():
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{name}.")
        elif type(value).__name__ == "DataFrame":
            yield from _of_table(value, f"{prefix}{name}.")
        elif isinstance(value, np.ndarray) and value.dtype.names and value.size == 1:
            fields = value.reshape(-1)[0]
            yield from _flattened({field: fields[field] for field in value.dtype.names}, f"{prefix}{name}.")
        elif isinstance(value, np.ndarray) and value.dtype.kind not in "OV":
            yield f"{prefix}{name}", _in_seconds(value), ""


def _of_table(table: Any, prefix: str) -> Iterator[tuple[str, np.ndarray, str]]:
    """Columns of a table; of a timetable also its row times."""
    if table.index.dtype.kind in "mM":
        yield f"{prefix}time_s", seconds_of(table.index.to_numpy()), ""
    stated = table.attrs.get("varUnits", table.attrs.get("VariableUnits", []))
    units = [str(unit) for unit in np.ravel(stated)]
    if len(units) != len(table.columns):
        units = [""] * len(table.columns)
    for place, name in enumerate(table.columns):
        values = table.iloc[:, place].to_numpy()
        if values.dtype.kind in "fiubmM":
            yield f"{prefix}{name}", _in_seconds(values), units[place]


def _in_seconds(values: np.ndarray) -> np.ndarray:
    return seconds_of(values) if values.dtype.kind in "mM" else values
