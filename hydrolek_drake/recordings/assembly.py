"""From the columns of a file to a checked recording."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.checks import numbers, signal_findings
from hydrolek_drake.recordings.clock import clock_findings, cut_off, ordered
from hydrolek_drake.recordings.columns import IGNORE, TIME, ColumnName, parse_column
from hydrolek_drake.recordings.recording import Recording
from hydrolek_drake.recordings.table import Column, Table

_LISTED = 20  # columns named in a message before it becomes unreadable


class _Used(NamedTuple):
    column: Column
    meaning: ColumnName


def assemble(table: Table, mapping: Mapping[str, str], path: Path) -> Recording:
    """Convert the columns that are understood to SI, check them, and note what is noteworthy.

    Args:
        table: What a reader found.
        mapping: Contract name by name in the file, from the rig.
        path: File, for messages.

    Raises:
        InputError: See `read_recording`.
    """
    used, ignored = _understood(table, mapping, path)
    if TIME not in used:
        raise InputError(
            f"{path} has no time column; it needs time_s (or time_ms, time_min ...), or a rig that maps one "
            f"of its columns to it under 'columns'; it has {_listed(table)}"
        )
    clock = used.pop(TIME)
    if not used:
        raise InputError(
            f"{path} has no signal: none of its columns is named <joint>.<quantity>_<unit>, as in "
            f"joint.command_V; map them in the rig under 'columns'; it has {_listed(table)}"
        )
    samples = len(clock.column.values)
    if samples == 0:
        raise InputError(f"{path} has no rows")
    for column, _ in used.values():
        if len(column.values) != samples:
            raise InputError(
                f"{path}: column {column.name!r} has {len(column.values)} rows; the time column "
                f"{clock.column.name!r} has {samples}"
            )

    time = numbers(clock.column, table, path) * clock.meaning.factor
    keep, duplicate = ordered(time, f"{path}: column {clock.column.name!r}", table.row)
    time = time[keep]
    if time.size < 2:
        raise InputError(f"{path} has {time.size} row at different times; a recording needs at least two")
    signals = {key: _in_si(one, table, path)[keep] for key, one in used.items()}
    for key, values in signals.items():
        if np.isnan(values).all():
            raise InputError(
                f"{path}: column {used[key].column.name!r} holds no number in any row; leave it out"
            )

    units = {key: one.meaning.unit for key, one in used.items()}
    findings = [*table.findings, *([duplicate] if duplicate else []), *clock_findings(time)]
    if table.cut_off:
        findings.append(cut_off(time))
    for key, values in signals.items():
        findings += signal_findings(time, key, values, units[key])
    return Recording(
        name=path.stem,
        time=time,
        signals=signals,
        source=path,
        findings=tuple(findings),
        ignored=ignored,
        units=units,
    )


def _understood(
    table: Table, mapping: Mapping[str, str], path: Path
) -> tuple[dict[str, _Used], tuple[str, ...]]:
    """The columns that hold time or a signal, by key, and the names of the others."""
    used: dict[str, _Used] = {}
    ignored = []
    for column in table.columns:
        try:
            meaning = _meaning(column, mapping)
        except InputError as error:
            raise InputError(f"{path}: {error}, or map it to '{IGNORE}' in the rig under 'columns'") from None
        if meaning is None:
            ignored.append(column.name)
            continue
        if meaning.key in used:
            other = used[meaning.key].column.name
            which = (
                f"column {column.name!r} is present twice"
                if other == column.name
                else f"columns {other!r} and {column.name!r} both hold {meaning.key}"
            )
            raise InputError(
                f"{path}: {which}; remove one or map it to '{IGNORE}' in the rig under 'columns'"
            )
        used[meaning.key] = _Used(column, meaning)
    return used, tuple(ignored)


def _meaning(column: Column, mapping: Mapping[str, str]) -> ColumnName | None:
    """What a column holds: the mapping decides, else the first of its names that is understood."""
    for name in column.names:
        if name in mapping:
            return None if mapping[name] == IGNORE else parse_column(mapping[name])
    refused: InputError | None = None
    for name in column.names:
        try:
            meaning = parse_column(name)
        except InputError as error:
            refused = refused or error
            continue
        if meaning is not None:
            return meaning
    if refused:
        raise refused
    return None


def _in_si(one: _Used, table: Table, path: Path) -> np.ndarray:
    with np.errstate(over="ignore"):
        values = numbers(one.column, table, path) * one.meaning.factor
    values[~np.isfinite(values)] = np.nan
    return values


def _listed(table: Table) -> str:
    names = [column.name for column in table.columns]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(repr(name) for name in names[:_LISTED]) + more if names else "no columns"
