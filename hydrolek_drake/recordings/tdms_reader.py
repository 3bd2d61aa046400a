"""NI TDMS files, as LabVIEW writes them."""

import logging
import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.clock import seconds_of
from hydrolek_drake.recordings.columns import TIME, parse_column
from hydrolek_drake.recordings.table import Column, Table

_LEAD_IN = struct.Struct("<4siiQQ")


def read_tdms(path: Path) -> Table:
    """Read every channel; it answers to `group.channel` and to `channel`.

    Time is a time channel or, where there is none, follows from the waveform properties `wf_start_offset` and
    `wf_increment` of the channels.

    Raises:
        InputError: There is no time channel, and the waveform properties of the channels differ.
    """
    from nptdms import TdmsFile

    with _quiet(), TdmsFile.open(path) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        surplus = _surplus(file.file_status.channel_statuses or {})
        columns = tuple(
            _column(
                (f"{channel.group_name}.{channel.name}", channel.name),
                channel[: len(channel) - surplus.get(channel.path, 0)],
            )
            for channel in channels
        )
        if not any(_is_time(column) for column in columns):
            waveforms = [channel for channel in channels if "wf_increment" in channel.properties]
            columns += _waveform_time(path, waveforms, surplus)
    return Table(columns, cut_off=_breaks_off(path))


def _breaks_off(path: Path) -> bool:
    """Whether the last segment is shorter than its lead-in says.

    The lead-in is 28 bytes: tag, contents, version, and the offsets of the next segment and of the raw data
    from the end of the lead-in (NI, TDMS file format internal structure).
    """
    size = path.stat().st_size
    position = 0
    with path.open("rb") as stream:
        while position < size:
            stream.seek(position)
            lead_in = stream.read(_LEAD_IN.size)
            if len(lead_in) < _LEAD_IN.size:
                return True
            position += _LEAD_IN.size + _LEAD_IN.unpack(lead_in)[3]
    return position > size


def _surplus(statuses: Mapping[str, Any]) -> dict[str, int]:
    """Samples at the end of each channel that other channels lack, because the last segment breaks off."""
    if len({status.expected_length for status in statuses.values()}) != 1:
        return {}
    least = min(status.read_length for status in statuses.values())
    return {channel: status.read_length - least for channel, status in statuses.items()}


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep npTDMS from printing remarks about damaged files; what they mean is said in our own words."""
    from nptdms.log import log_manager

    level = log_manager.log_level
    log_manager.set_level(logging.CRITICAL)
    try:
        yield
    finally:
        log_manager.set_level(level)


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


def _waveform_time(path: Path, channels: list[Any], surplus: Mapping[str, int]) -> tuple[Column, ...]:
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
    return (Column((f"{TIME}_s",), offset + increment * np.arange(samples - surplus.get(first.path, 0))),)


def _waveform(channel: Any) -> tuple[float, float, str, int]:
    properties = channel.properties
    return (
        float(properties["wf_increment"]),
        float(properties.get("wf_start_offset", 0.0)),
        str(properties.get("wf_start_time", "")),
        len(channel),
    )
