"""Channels of a measurement file of ASAM MDF, versions 3 and 4, by asammdf."""

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.recordings.apart.found import Asked, Found, names_with_unit


def load(asked: Asked) -> None:
    """Load the package that reads."""
    import asammdf  # noqa: F401


def read(path: Path, asked: Asked) -> Iterator[Found]:
    """Channels of all groups that are asked for, and the names of the others.

    A channel is `group.channel` and `channel`, both also with the unit that the file states; the time of a group is its
    `time_s`. A group is called as its acquisition is, or `groupN` with N from 0.
    """
    from asammdf import MDF

    logging.disable(logging.CRITICAL)
    with MDF(path) as file:
        taken: set[str] = set()
        for index, group in enumerate(file.groups):
            name = _name(group, index)
            name = f"{name}_{index}" if name in taken else name
            taken.add(name)
            yield from _of_group(file, index, group, name, asked)


def _name(group: Any, index: int) -> str:
    said = getattr(group.channel_group, "acq_name", "") or ""
    said = " ".join(str(said).split())
    return said.replace(".", "_") if said.isprintable() and 0 < len(said) < 60 else f"group{index}"


def _of_group(file: Any, index: int, group: Any, called: str, asked: Asked) -> Iterator[Found]:
    time: np.ndarray | None = None
    master = file.masters_db.get(index)
    for place, channel in enumerate(group.channels):
        if place == master:
            continue
        unit = str(channel.unit or getattr(channel.conversion, "unit", "") or "")
        names = names_with_unit((f"{called}.{channel.name}", channel.name), unit)
        if not asked.wants(names) and f"{called}.time_s" not in asked.mapped:
            yield Found(names, None, called)
            continue
        signal = file.get(group=index, index=place, ignore_invalidation_bits=True)
        values = np.asarray(signal.samples)
        if values.ndim != 1 or values.dtype.kind not in "fiub":
            yield Found(names, None, called)
            continue
        values = values.astype(float)
        if signal.invalidation_bits is not None:
            values[np.asarray(signal.invalidation_bits, dtype=bool)] = np.nan
        yield Found(names, values, called)
        time = np.asarray(signal.timestamps, dtype=float)
    if time is not None:
        yield Found((f"{called}.time_s", "time_s"), time, called)
