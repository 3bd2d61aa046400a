"""ROS bags: folders, MCAP, sqlite3 and ROS 1 files; any numeric field of any message."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from hydrolek_drake.recordings.apart.bag import LOGGED, STAMPED
from hydrolek_drake.recordings.apart.process import columns_apart
from hydrolek_drake.recordings.clock import seconds_of
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.table import Column, Table

_BYTES_PER_S = 1e5
"""What is read of a bag in a second at least; messages are decoded one by one, of 0.1 to 1 kB each."""

_RATE = 0.01
"""Stamps whose time runs by more than this share slower or faster than the recorder's are of a simulated clock."""

_SAME_CLOCK = 1.0
"""Messages that reach the recorder within this time [s] of their stamp carry the recorder's own time: no
network is slower."""


def read_bag(path: Path, mapping: Mapping[str, str]) -> Table:
    """Read the topics of a bag of which a column is mapped or has a name of the contract; see `apart.bag`.

    A topic's time is the stamp of its messages' headers. Where a topic has no stamps, or stamps are of
    several clocks, all topics are put on the recorder's: stamps, which are more regular than times of
    arrival, are moved by the least time that a message took to arrive. Where stamps are of another clock that
    runs at another rate (a simulation), all times are those of arrival.
    """
    columns = columns_apart("bag", path, mapping, bytes_per_s=_BYTES_PER_S)
    logged = _times(columns, LOGGED)
    stamped = _times(columns, STAMPED)
    others = [
        column
        for column in columns
        if column.name not in (f"{column.group}.{LOGGED}", f"{column.group}.{STAMPED}")
    ]
    took = {group: (logged[group] - stamps).min() / 1e9 for group, stamps in stamped.items() if stamps.all()}
    times, findings = stamped, list[Finding]()
    if logged.keys() != took.keys() or (took and np.ptp(list(took.values())) > _SAME_CLOCK):
        times, findings = _by_arrival(logged, stamped, took)
    by_log = [Column((f"{group}.{LOGGED}",), _seconds(time), group) for group, time in logged.items()]
    timed = [Column((f"{group}.{STAMPED}", STAMPED), _seconds(time), group) for group, time in times.items()]
    return Table((*others, *by_log, *timed), row_name="message", findings=tuple(findings))


def _times(columns: list[Column], ending: str) -> dict[str, np.ndarray]:
    """Times of each group [ns]."""
    return {column.group: column.values for column in columns if column.name == f"{column.group}.{ending}"}


def _seconds(nanoseconds: np.ndarray) -> np.ndarray:
    return seconds_of(nanoseconds.astype("m8[ns]"))


def _by_arrival(
    logged: dict[str, np.ndarray], stamped: dict[str, np.ndarray], took: dict[str, float]
) -> tuple[dict[str, np.ndarray], list[Finding]]:
    """All groups on the recorder's clock [ns], and what was moved."""
    times = dict(logged)
    told = []
    for group, least in took.items():
        passed = np.ptp(logged[group])
        if passed > 0 and abs(np.ptp(stamped[group]) / passed - 1.0) < _RATE:
            times[group] = stamped[group] + (logged[group] - stamped[group]).min()
            if abs(least) > _SAME_CLOCK:
                told.append(f"{group} by {least:.6g} s")
    if not told:
        return times, []
    message = (
        "some topics have no stamps or are stamped by another clock, so all times are the recorder's; "
        f"stamps were moved: {', '.join(told)}"
    )
    return times, [Finding("offset", None, message, ())]
