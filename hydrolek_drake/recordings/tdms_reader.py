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

    Time is a time channel, of the whole file or of each group; where there is none, it follows from the
    waveform properties `wf_start_time`, `wf_start_offset` and `wf_increment` of the channels, which may
    differ.

    Raises:
        InputError: There is no time channel, and a waveform's increment is not above zero.
    """
    from nptdms import TdmsFile

    with _quiet(), TdmsFile.open(path) as file:
        channels = [channel for group in file.groups() for channel in group.channels()]
        surplus = _surplus(file.file_status.channel_statuses or {})
        columns = tuple(
            _column(
                (f"{channel.group_name}.{channel.name}", channel.name),
                channel[: len(channel) - surplus.get(channel.path, 0)],
                channel.group_name,
            )
            for channel in channels
        )
        if not any(_is_time(column) for column in columns):
            columns = _with_waveform_time(path, channels, columns)
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


def _column(names: tuple[str, ...], values: np.ndarray, group: str) -> Column:
    values = np.asarray(values)
    if values.dtype.kind == "M":
        return Column((*names, f"{names[-1]}_s"), seconds_of(values), group)
    return Column(names, values, group)


def _is_time(column: Column) -> bool:
    for name in column.names:
        try:
            understood = parse_column(name)
        except InputError:
            continue  # what is wrong with the name is said where columns are resolved
        if understood is not None and understood.key == TIME:
            return True
    return False


def _with_waveform_time(path: Path, channels: list[Any], columns: tuple[Column, ...]) -> tuple[Column, ...]:
    """The columns, those of one waveform as a group with its time; it begins where the first waveform does."""
    sampled = [channel for channel in channels if "wf_increment" in channel.properties]
    starts = [start for channel in sampled if (start := _start(channel)) is not None]
    origin = min(starts) if len(starts) == len(sampled) and starts else None
    times: dict[tuple[float, float, int], Column] = {}
    of_waveform = []
    for channel, column in zip(channels, columns, strict=True):
        if "wf_increment" not in channel.properties:
            of_waveform.append(column)
            continue
        increment, offset = (_number(path, channel, name) for name in ("wf_increment", "wf_start_offset"))
        if origin is not None:
            offset += float(seconds_of(np.array([_start(channel) - origin]))[0])
        if not (np.isfinite(increment) and increment > 0 and np.isfinite(offset)):
            raise InputError(
                f"{path}: channel {channel.name!r} has wf_increment {increment}; it must be above zero"
            )
        waveform = (increment, offset, len(column.values))
        if waveform not in times:
            time = offset + increment * np.arange(len(column.values))
            times[waveform] = Column((f"{column.name}.{TIME}_s", f"{TIME}_s"), time, column.name)
        of_waveform.append(Column(column.names, column.values, times[waveform].group))
    return (*of_waveform, *times.values())


def _start(channel: Any) -> Any:
    """When a waveform was begun, if the file says so."""
    start = channel.properties.get("wf_start_time")
    if start is None:
        return None
    try:
        return np.datetime64(start, "ns")
    except ValueError:
        return None


def _number(path: Path, channel: Any, name: str) -> float:
    value = channel.properties.get(name, 0.0)
    try:
        return float(value)
    except (TypeError, ValueError):
        raise InputError(
            f"{path}: channel {channel.name!r} has {name} {value!r}; it must be a number"
        ) from None
