"""Recordings from whatever a notebook has: paths, DataFrames of pandas, or recordings; and back to a DataFrame."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from hydrolek_drake.api.results import pandas_module
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.recordings.columns import column_name
from hydrolek_drake.rigs import Rig

if TYPE_CHECKING:
    import pandas

    Given: TypeAlias = str | Path | Recording | pandas.DataFrame
    """A recording, or what one is read from."""


def recording_of(given: Given, rig: Rig | None = None) -> Recording:
    """A recording from a path or a DataFrame; one that is a recording already is itself.

    Args:
        given: path, DataFrame or recording.
        rig: whose column names apply; None for `<joint>.<quantity>_<unit>` alone.

    Raises:
        InputError: as of `recordings.read_recording`.
    """
    if isinstance(given, Recording):
        return given
    if rig is None:
        return read_recording(given)
    from hydrolek_drake.checking.clock import refuse_other_clock

    recording = read_recording(given, rig.columns, dead_time=rig.dead_time)
    refuse_other_clock(rig, recording)
    return recording


def recordings_of(given: Given | Sequence[Given], rig: Rig) -> list[Recording]:
    """Recordings of one or several; see `recording_of`."""
    several: Any = given if isinstance(given, list | tuple) else [given]
    return [recording_of(each, rig) for each in several]


def to_pandas(recording: Recording) -> pandas.DataFrame:
    """A recording as a DataFrame that `read` gives back: `time_s` and `<joint>.<quantity>_<unit>`, in SI units.

    Args:
        recording: as read.

    Raises:
        InputError: pandas is not installed.
    """
    columns = {"time_s": recording.time}
    for key, values in recording.signals.items():
        columns[column_name(key, recording.units[key])] = values
    frame = pandas_module().DataFrame(columns)
    frame.attrs["name"] = recording.name
    return frame
