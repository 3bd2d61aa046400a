"""MATLAB .mat files: v5 to v7 through SciPy, v7.3 through h5py."""

from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.mat_process import mat_variables
from hydrolek_drake.recordings.table import Column, Table

_OLDEST_MAJOR, _HDF5_MAJOR = 1, 2  # what SciPy calls v5 to v7, and v7.3


def read_mat(path: Path) -> Table:
    """Read every variable that is a row or a column of values; fields of structs are `struct.field`.

    A field also answers to the ends of its name: `log.joint.angle_deg` to `joint.angle_deg` and `angle_deg`.

    Raises:
        InputError: The file is older than version 5.
    """
    from scipy.io import matlab

    major, _ = matlab.matfile_version(str(path))
    if major < _OLDEST_MAJOR:
        raise InputError(f"{path} is not a MATLAB file of version 5 or later; save it with -v7 or -v7.3")
    variables = _hdf5_variables(path) if major == _HDF5_MAJOR else mat_variables(path)
    return Table(tuple(_column(name, values) for name, values in variables if _is_column(values)))


def _column(name: str, values: np.ndarray) -> Column:
    parts = name.split(".")
    return Column(tuple(".".join(parts[start:]) for start in range(len(parts))), values.ravel())


def _hdf5_variables(path: Path) -> list[tuple[str, np.ndarray]]:
    import h5py

    found: list[tuple[str, np.ndarray]] = []

    def visit(name: str, item: Any) -> None:
        # Groups whose names start with '#' hold the contents of cells and objects, not variables.
        if isinstance(item, h5py.Dataset) and not name.startswith("#") and item.dtype.kind in "fiub":
            text = item.attrs.get("MATLAB_class") == b"char"
            if not text and "MATLAB_empty" not in item.attrs and _is_column(item):
                found.append((name.replace("/", "."), item[()]))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


def _is_column(values: Any) -> bool:
    """Whether an array is n, n x 1 or 1 x n with more than one element (one element is a parameter)."""
    return values.ndim in (1, 2) and max(values.shape) > 1 and (values.ndim == 1 or min(values.shape) == 1)
