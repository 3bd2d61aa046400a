"""MATLAB .mat files: v5 to v7 through SciPy, v7.3 through h5py, tables and timetables through mat-io."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.apart.matlab import ends, is_column
from hydrolek_drake.recordings.apart.process import columns_apart, missing
from hydrolek_drake.recordings.table import Column, Table

_OLDEST_MAJOR, _HDF5_MAJOR = 1, 2  # what SciPy calls v5 to v7, and v7.3
_OBJECTS_AT = slice(116, 124)
"""Bytes of the header that say where MATLAB's objects are kept: zeros or blanks where there are none."""


def read_mat(path: Path, mapping: Mapping[str, str]) -> Table:
    """Read every variable that is a row or a column of values; fields of structs are `struct.field`.

    A field also answers to the ends of its name: `log.joint.angle_deg` to `joint.angle_deg` and `angle_deg`. Columns
    of a table or timetable are fields of it; row times of a timetable are its `time_s`.

    Raises:
        InputError: The file is older than version 5.
    """
    from scipy.io import matlab

    major, _ = matlab.matfile_version(str(path))
    if major < _OLDEST_MAJOR:
        raise InputError(f"{path} is not a MATLAB file of version 5 or later; save it with -v7 or -v7.3")
    hdf5 = major == _HDF5_MAJOR
    objects = _has_objects_hdf5(path) if hdf5 else _has_objects(path)
    hint = missing("matio", "MATLAB's tables, timetables and strings") if objects else ""
    if objects and not hint:
        try:
            return Table(tuple(columns_apart("matlab", path, mapping, objects=True)))
        except (
            ValueError
        ) as error:  # of an object of a kind that mat-io does not know; what is plain can be read
            hint = f"its tables and objects cannot be read: {' '.join(str(error).split())[:120]}"
    if hdf5:
        columns = [_column(name, values) for name, values in _hdf5_variables(path)]
    else:
        columns = columns_apart("matlab", path, mapping, objects=False)
    return Table(tuple(columns), hint=hint)


def _has_objects(path: Path) -> bool:
    with path.open("rb") as stream:
        place = stream.read(_OBJECTS_AT.stop)[_OBJECTS_AT]
    return place.strip(b" \0") != b""


def _has_objects_hdf5(path: Path) -> bool:
    import h5py

    with h5py.File(path, "r") as file:
        return "#subsystem#" in file


def _column(name: str, values: np.ndarray) -> Column:
    return Column(tuple(ends(name)), values.ravel(), name.rpartition(".")[0])


def _hdf5_variables(path: Path) -> list[tuple[str, np.ndarray]]:
    import h5py

    found: list[tuple[str, np.ndarray]] = []

    def visit(name: str, item: Any) -> None:
        # Groups whose names start with '#' hold the contents of cells and objects, not variables.
        if isinstance(item, h5py.Dataset) and not name.startswith("#") and item.dtype.kind in "fiub":
            text = item.attrs.get("MATLAB_class") == b"char"
            if not text and "MATLAB_empty" not in item.attrs and is_column(item):
                found.append((name.replace("/", "."), item[()]))

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found
