"""NI TDMS files, as LabVIEW writes them."""

from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.clock import seconds_of
from hydrolek_drake.recordings.columns import TIME, parse_column
from hydrolek_drake.recordings.table import Column, Table


def read_tdms(path: Path) -> Table:
    """Read every channel; it answers to `group.channel` and to `channel`.

    Time is a time channel or, where there is none, follows from the waveform properties `wf_start_offset` and
    `wf_increment` of the channels.

    Raises:
        InputError: There is no time channel, and the waveform properties of the channels differ.
    """
    from nptdms import TdmsFile

    with TdmsFile.open(path) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        columns = tuple(
            _column((f"{channel.group_name}.{channel.name}", channel.name), channel[:])
            for channel in channels
        )
        if not any(_is_time(column) for column in columns):
            columns += _waveform_time(
                path, [channel for channel in channels if "wf_increment" in channel.properties]
            )
    return Table(columns)


def _column(names: tuple[str, ...], values: np.ndarray) -> Column:
    values = np.asarray(values)
    if values.dtype.kind == "M":
        return Column((*names, f"{names[-1]}_s"), seconds_of(values))
    return Column(names, values)


def _is_time(column: Column) -> bool:
    for name in column.names:
        try:
            understood = parse_column(name)
        except InputError:
            continue  # what is wrong with the name is said where columns are resolved
        if understood is not None and understood.key == TIME:
            return True
    return False


def _waveform_time(path: Path, channels: list[Any]) -> tuple[Column, ...]:
    """The time column that the waveform properties of the channels agree on."""
    if not channels:
        return ()
    first = channels[0]
    for channel in channels[1:]:
        if _waveform(channel) != _waveform(first):
            raise InputError(
                f"{path}: channels {first.name!r} and {channel.name!r} have different waveform times "
                f"{_waveform(first)} and {_waveform(channel)} (increment, offset, start, samples); "
                "add a time channel or export them at one rate"
            )
    increment, offset, _, samples = _waveform(first)
    if not (np.isfinite(increment) and increment > 0 and np.isfinite(offset)):
        raise InputError(
            f"{path}: channel {first.name!r} has wf_increment {increment}; it must be above zero"
        )
    return (Column((f"{TIME}_s",), offset + increment * np.arange(samples)),)


def _waveform(channel: Any) -> tuple[float, float, str, int]:
    properties = channel.properties
    return (
        float(properties["wf_increment"]),
        float(properties.get("wf_start_offset", 0.0)),
        str(properties.get("wf_start_time", "")),
        len(channel),
    )
