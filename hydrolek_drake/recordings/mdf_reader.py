"""Measurement files of ASAM MDF (.mf4, .mdf, .dat)."""

from collections.abc import Mapping
from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.apart.process import columns_apart, missing
from hydrolek_drake.recordings.table import Table


def read_mdf(path: Path, mapping: Mapping[str, str]) -> Table:
    """Read the channels that are mapped or have a name of the contract; each group has its own clock.

    Raises:
        InputError: asammdf is not installed.
    """
    if hint := missing("asammdf", "MDF files"):
        raise InputError(f"{path}: {hint}")
    return Table(tuple(columns_apart("mdf", path, mapping)))
