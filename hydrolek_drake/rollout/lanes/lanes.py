"""Many machines rolled out in lanes: the front door of `kernel`."""

import contextlib
import os
import threading
from collections.abc import Iterator, Sequence
from typing import Protocol

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.physics.law import MOST_TERMS
from hydrolek_drake.physics.lines.hose import LONG_LINE
from hydrolek_drake.physics.probes import NO_PROBE
from hydrolek_drake.physics.records import JOINT, flat
from hydrolek_drake.rollout import kernel
from hydrolek_drake.rollout.lanes.compiling import compiled, ready
from hydrolek_drake.rollout.lanes.kernel import integrate_lanes
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.lanes.table import filled_up, side_by_side
from hydrolek_drake.rollout.lanes.view import LANES, Kind
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.rollout import (
    DIVIDED_BY_ZERO,
    Outcome,
    Signals,
    check_driven,
    check_times,
    missing_number,
    why_diverged,
    with_own,
)
from hydrolek_drake.rollout.run import Run

SWITCH, OFF = "HYDROLEK_LANES", "0"
"""Environment variable, and its value with which machines are rolled out one by one, as for a comparison."""

FEW = 2
"""So many machines take no longer one by one."""


class Shared(Protocol):
    """Rolls out what several threads want."""

    def roll_out(self, runs: Sequence["Run"]) -> list[Outcome]:
        """As of `roll_out_lanes`."""
        ...

    def waiting(self) -> contextlib.AbstractContextManager[None]:
        """While this thread waits for another one."""
        ...


_of_this_thread = threading.local()


@contextlib.contextmanager
def together_with(tables: Shared | None) -> Iterator[None]:
    """Within it this thread's machines are rolled out with those of others (`pool`); None for by itself."""
    before = sharing()
    _of_this_thread.tables = tables
    try:
        yield
    finally:
        _of_this_thread.tables = before


def sharing() -> Shared | None:
    """With what this thread's machines are rolled out, if it is not alone."""
    return getattr(_of_this_thread, "tables", None)


@contextlib.contextmanager
def one_by_one() -> Iterator[None]:
    """Within it machines are rolled out one after the other, as for a comparison; in processes begun there too."""
    before = os.environ.get(SWITCH)
    os.environ[SWITCH] = OFF
    try:
        yield
    finally:
        if before is None:
            del os.environ[SWITCH]
        else:
            os.environ[SWITCH] = before


def roll_out_lanes(runs: Sequence[Run], *, at_once: bool = False) -> list[Outcome]:
    """Drive several machines side by side; each does what it does alone (`Run.outcome`), to the last bit.

    They may differ in everything. What takes a program of its own (`kind_of`) goes with its like; machines with laws of
    more than `MOST_TERMS` terms are driven alone.

    Args:
        runs: machines, and what each is driven with.
        at_once: compile what is not compiled yet, and wait for it; else the machines are driven one by one until that
            is done (`compiling`).

    Returns:
        What each of them did, in their order. One that diverges disturbs no other.

    Raises:
        InputError: as of `roll_out`.
    """
    off = os.environ.get(SWITCH) == OFF
    if not at_once and not off and (tables := sharing()) is not None:
        return tables.roll_out(runs)
    if not at_once and (len(runs) <= FEW or off):
        return [run.outcome() for run in runs]
    found: dict[int, Outcome] = {}
    groups: dict[Kind, list[int]] = {}
    laws = [with_own(run.law, run.joint) for run in runs]
    for i, (run, law) in enumerate(zip(runs, laws, strict=True)):
        if _in_lanes(run, law):
            groups.setdefault(_kind(run, law), []).append(i)
        else:
            found[i] = run.outcome()
    for kind, members in groups.items():
        first = runs[members[0]]
        if at_once or (
            len(members) > FEW and ready(kind, first.joint, laws[members[0]], len(members), first.spool_steps)
        ):
            alike = sorted(members, key=lambda i: (len(runs[i].times), runs[i].longest_step))
            for at in range(0, len(alike), LANES):
                chosen = alike[at : at + LANES]
                done = one_table(kind, [runs[i] for i in chosen], [laws[i] for i in chosen])
                found |= dict(zip(chosen, done, strict=True))
            compiled(kind)
        else:
            found |= {i: runs[i].outcome() for i in members}
    return [found[i] for i in range(len(runs))]


def one_table(kind: Kind, runs: Sequence[Run], laws: Sequence[np.ndarray | None]) -> list[Outcome]:
    """At most `LANES` machines of one kind; lanes that are left do what the last one does.

    Args:
        kind: of all of them.
        runs: machines, and what each is driven with.
        laws: of each, with that of its record.
    """
    lanes = [*runs, *[runs[-1]] * (LANES - len(runs))]
    joints = np.empty(LANES, dtype=JOINT)
    for lane, run in enumerate(lanes):
        flat(joints)[lane] = flat(run.joint)[0]
    commands = [_changes(run.command_times, run.command_values) for run in lanes]
    for run in runs:
        check_times(run.command_times, run.command_values, run.times)
        check_driven(run.joint, run.probes is not None)
    rows = np.array([len(run.times) for run in lanes])
    pulls = any(run.pull is not None for run in runs)
    measured = np.full((LANES, int(rows.max()) if pulls else 0, len(kernel.PULLED)), np.nan)
    for lane, run in enumerate(lanes):
        if run.pull is not None:
            measured[lane, : rows[lane]] = run.pull[1]
    terms, numbers = None, flat(joints)
    if kind.terms:
        own = [law for law in laws if law is not None]
        terms = np.stack([filled_up(law, kind.terms) for law in (*own, *[own[-1]] * (LANES - len(own)))])
        numbers = np.concatenate([numbers, terms.view(np.float64).reshape(LANES, -1)], axis=1)
    states = np.stack([rest_state(run.joint) if run.state is None else run.state for run in lanes])
    out = np.full((LANES, int(rows.max()), len(kernel.SIGNALS)), np.nan)
    done = np.zeros(LANES, dtype=np.int64)
    integrate_lanes(
        kind,
        joints,
        np.ascontiguousarray(numbers),
        terms,
        states,
        side_by_side([times for times, _ in commands], np.inf),
        side_by_side([values for _, values in commands], np.nan),
        side_by_side([run.times for run in lanes], np.nan),
        rows,
        np.array([run.longest_step for run in lanes]),
        max(
            _most_steps(run.times, times, run.longest_step)
            for run, (times, _) in zip(runs, commands, strict=False)
        ),
        np.array([0.0 if run.pull is None else run.pull[0] for run in lanes]),
        measured,
        *_outside(lanes),
        out,
        done,
    )
    found = []
    for lane, run in enumerate(runs):
        diverged = None
        signals = out[lane, : rows[lane]]
        if done[lane] < rows[lane]:
            diverged = why_diverged(run.joint, float(run.times[done[lane]]))
            if diverged == DIVIDED_BY_ZERO:
                signals[:] = np.nan
        found.append(Outcome(Signals(read_only(run.times), *signals.T), diverged, states[lane]))
    return found


def _changes(times: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A command without what only repeats it."""
    changes = np.concatenate([[True], np.diff(values) != 0.0])
    return times[changes], values[changes]


def _outside(lanes: Sequence[Run]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Spacing, places and samples of inputs from outside, as of `integrate_lanes`, those of several machines once."""
    spacing, places = np.ones(len(lanes)), np.zeros((len(lanes), 2), dtype=np.int64)
    begins: dict[int, int] = {}
    samples, end = [NO_PROBE], 0
    for lane, run in enumerate(lanes):
        if run.probes is None:
            continue
        spacing[lane], values = run.probes
        if id(values) not in begins:
            begins[id(values)] = end
            # a single sample is a line between it and itself
            samples.append(values if len(values) != 1 else np.repeat(values, 2, axis=0))
            end += len(samples[-1])
        places[lane] = begins[id(values)], max(len(values), 2) if len(values) else 0
    return spacing, places, np.ascontiguousarray(np.concatenate(samples))


def _in_lanes(run: Run, law: np.ndarray | None) -> bool:
    """Whether there can be a loop over lanes for a machine; long lines are not followed in one."""
    if run.joint["hose"]["variant"][0] == LONG_LINE:
        return False
    return (law is None or len(law) <= MOST_TERMS) and missing_number(run.joint) is None and _begins(run)


def _begins(run: Run) -> bool:
    """Whether a machine has a state to begin with; one that divides by zero has none."""
    if run.state is None:
        try:
            rest_state(run.joint)
        except ZeroDivisionError:
            return False
    return True


def compiled_kind_of(run: Run, law: np.ndarray | None) -> Kind | None:
    """The kind of a machine, if its loop over lanes is compiled; else it goes alone, and counts for when it will be.

    Args:
        run: the machine.
        law: with that of its record.
    """
    if not _in_lanes(run, law):
        return None
    kind = _kind(run, law)
    return kind if ready(kind, run.joint, law, 1, run.spool_steps) else None


def _kind(run: Run, law: np.ndarray | None) -> Kind:
    return kind_of(run.joint, run.spool_steps, law, run.probes is not None and len(run.probes[1]) > 0)


def _most_steps(times: np.ndarray, moments: np.ndarray, longest_step: float) -> int:
    """At least as many steps as any machine takes between two of `times`: each command that arrives adds one."""
    if len(times) < 2:
        return 1
    longest = float(np.diff(times).max())
    within = np.searchsorted(moments, moments + longest, side="right") - np.arange(len(moments))
    return int(np.ceil(longest / longest_step)) + int(within.max()) + 2
