"""From the columns of a file to a checked recording."""

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.checks import numbers, signal_findings
from hydrolek_drake.recordings.clock import clock_findings, cut_off, ordered
from hydrolek_drake.recordings.columns import IGNORE, TIME, ColumnName, parse_column
from hydrolek_drake.recordings.finding import Finding
from hydrolek_drake.recordings.one_clock import Sampled, on_one_clock
from hydrolek_drake.recordings.recording import Recording
from hydrolek_drake.recordings.table import Column, Table

_LISTED = 20  # columns named in a message before it becomes unreadable


class _Used(NamedTuple):
    column: Column
    meaning: ColumnName
    mapped: bool


def assemble(table: Table, mapping: Mapping[str, str], path: Path, dead_time: float = 0.0) -> Recording:
    """Convert the columns that are understood to SI, check them, put them on one clock, and note what is noteworthy.

    Args:
        table: What a reader found.
        mapping: Contract name by name in the file, from the rig.
        path: File, for messages.
        dead_time: See `read_recording`.

    Raises:
        InputError: See `read_recording`.
    """
    used, clocks, ignored = _understood(table, mapping, path)
    hint = f"; {table.hint}" if table.hint else ""
    if not clocks:
        raise InputError(
            f"{path} has no time column; it needs time_s (or time_ms, time_min ...), or a rig that maps one "
            f"of its columns to it under 'columns'; it has {_listed(table)}{hint}"
        )
    if not used:
        raise InputError(
            f"{path} has no signal: none of its columns is named <joint>.<quantity>_<unit>, as in "
            f"joint.command_V; map them in the rig under 'columns'; it has {_listed(table)}{hint}"
        )
    sampled, findings = _sampled(table, used, clocks, path)
    by_hand = {_called(one, group) for group, one in clocks.items() if one.mapped}
    names = {one.clock for one in sampled.values()}
    if len(names) == 1:
        time = next(iter(sampled.values())).time
        signals = {key: one.values for key, one in sampled.items()}
    else:
        chosen = next(iter(by_hand & names)) if len(by_hand & names) == 1 else None
        try:
            time, signals, told = on_one_clock(sampled, chosen, dead_time)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None
        findings += told
    if time.size < 2:
        raise InputError(f"{path} has {time.size} row at different times; a recording needs at least two")
    units = {key: one.meaning.unit for key, one in used.items()}
    findings += clock_findings(time)
    if table.cut_off:
        findings.append(cut_off(time))
    for key, values in signals.items():
        if np.isnan(values).all():
            raise InputError(
                f"{path}: column {used[key].column.name!r} holds no number in any row"
                + ("; leave it out" if len(names) == 1 else " of the time of the others; leave it out")
            )
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


def _sampled(
    table: Table, used: Mapping[str, _Used], clocks: Mapping[str, _Used], path: Path
) -> tuple[dict[str, Sampled], list[Finding]]:
    """Each signal in SI at the times of its clock, in order and without repetitions."""
    findings = list(table.findings)
    times: dict[str, tuple[str, np.ndarray, np.ndarray]] = {}
    sampled: dict[str, Sampled] = {}
    for key, one in used.items():
        group = _group_of_clock(one.column, clocks, path)
        clock = clocks[group]
        name, samples = clock.column.name, len(clock.column.values)
        if samples == 0:
            raise InputError(
                f"{path} has no rows" + (f" of {_called(clock, group)}" if len(clocks) > 1 else "")
            )
        if len(one.column.values) != samples:
            raise InputError(
                f"{path}: column {one.column.name!r} has {len(one.column.values)} rows; the time column "
                f"{name!r} has {samples}"
            )
        if group not in times:
            time = numbers(clock.column, table, path) * clock.meaning.factor
            keep, duplicate = ordered(time, f"{path}: column {name!r}", table.row)
            same = next((known for known in times.values() if np.array_equal(known[1], time[keep])), None)
            times[group] = (same[0] if same else _called(clock, group), time[keep], keep)
            findings += [duplicate] if duplicate and not same else []
        called, time, keep = times[group]
        sampled[key] = Sampled(called, time, _in_si(one, table, path)[keep])
    return sampled, findings


def _called(clock: _Used, group: str) -> str:
    """What a clock is called in messages."""
    return group or clock.column.name


def _group_of_clock(column: Column, clocks: Mapping[str, _Used], path: Path) -> str:
    """The group whose time column is a column's: its own, the nearest around it, or the only one there is."""
    group = column.group
    while group not in clocks and group:
        group = group.rpartition(".")[0]
    if group in clocks:
        return group
    if len(clocks) == 1:
        return next(iter(clocks))
    raise InputError(
        f"{path}: column {column.name!r} has no time of its own, and there are several: "
        f"{', '.join(repr(clock.column.name) for clock in list(clocks.values())[:_LISTED])}; map those that are "
        f"none to '{IGNORE}' in the rig under 'columns'"
    )


def _understood(
    table: Table, mapping: Mapping[str, str], path: Path
) -> tuple[dict[str, _Used], dict[str, _Used], tuple[str, ...]]:
    """The columns that hold a signal, by key; those that hold time, by group; and the names of the others.

    What the rig maps comes before what is only called so.
    """
    used: dict[tuple[str, str], _Used] = {}
    ignored = []
    for column in table.columns:
        try:
            meaning, mapped = _meaning(column, mapping)
        except InputError as error:
            raise InputError(f"{path}: {error}, or map it to '{IGNORE}' in the rig under 'columns'") from None
        if meaning is None:
            ignored.append(column.name)
            continue
        place = (meaning.key, column.group if meaning.key == TIME else "")
        other = used.get(place)
        if other is None or (mapped and not other.mapped):
            used[place] = _Used(column, meaning, mapped)
            ignored += [other.column.name] if other else []
        elif other.mapped and not mapped:
            ignored.append(column.name)
        else:
            raise InputError(
                f"{path}: {_both(other.column.name, column.name, meaning.key)}; remove one or map it to '{IGNORE}' in "
                "the rig under 'columns'"
            )
    clocks = {group: one for (key, group), one in used.items() if key == TIME}
    return {key: one for (key, _), one in used.items() if key != TIME}, clocks, tuple(ignored)


def _both(first: str, second: str, key: str) -> str:
    if first == second:
        return f"column {first!r} is present twice"
    return f"columns {first!r} and {second!r} both hold {key}"


def _meaning(column: Column, mapping: Mapping[str, str]) -> tuple[ColumnName | None, bool]:
    """What a column holds, and whether the mapping says so; else the first of its names that is understood."""
    for name in column.names:
        if name in mapping:
            return (None if mapping[name] == IGNORE else parse_column(mapping[name])), True
    refused: InputError | None = None
    for name in column.names:
        try:
            meaning = parse_column(name)
        except InputError as error:
            refused = refused or error
            continue
        if meaning is not None:
            return meaning, False
    if refused:
        raise refused
    return None, False


def _in_si(one: _Used, table: Table, path: Path) -> np.ndarray:
    with np.errstate(over="ignore"):
        values = numbers(one.column, table, path) * one.meaning.factor
    values[~np.isfinite(values)] = np.nan
    return values


def _listed(table: Table) -> str:
    names = [column.name for column in table.columns]
    more = f" and {len(names) - _LISTED} more" if len(names) > _LISTED else ""
    return ", ".join(repr(name) for name in names[:_LISTED]) + more if names else "no columns"
