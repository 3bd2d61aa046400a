"""Many machines rolled out in lanes: the front door of `lane_kernel`."""

import contextlib
import os
import threading
from collections.abc import Iterator, Sequence
from functools import cache
from typing import Protocol

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.physics.law import LAW, MOST_TERMS
from hydrolek_drake.physics.records import JOINT, STAGES, flat, position_of
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.rollout import kernel
from hydrolek_drake.rollout.drive import acts_early
from hydrolek_drake.rollout.lane_compiling import compiled, ready
from hydrolek_drake.rollout.lane_kernel import integrate_lanes
from hydrolek_drake.rollout.lane_view import LANES, Kind
from hydrolek_drake.rollout.rollout import (
    DIVIDED_BY_ZERO,
    Outcome,
    Signals,
    check_times,
    missing_number,
    rest_state,
    why_diverged,
    with_own,
)
from hydrolek_drake.rollout.run import Run

GROUPS = (
    ("rod_friction", "load_friction"),
    ("coil_gain", "flow_gain", "viscous_gain"),
    ("spool_friction",),
    ("linkage_gap",),
    ("base_stiffness", "base_inertia"),
)
"""Hooks whose effects take time in every step, or make it another program. A loop over lanes is compiled with a group
or without it; what enters at other hooks costs little, and is a number that may be zero."""

SOMETIMES = ("command.ramp", "amplifier.coil_time", "valve.flow_force", "cylinder.stop_stiffness")
"""Parameters of the stages that most machines have at zero, and that cost as much."""


SWITCH, OFF = "HYDROLEK_LANES", "0"
"""Environment variable, and its value with which machines are rolled out one by one, as for a comparison."""

TERMS = (1, 2, 3, MOST_TERMS)
"""Numbers of a law's terms for which loops are compiled; a law in between gets terms of no size."""

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
def together_with(tables: Shared) -> Iterator[None]:
    """Within it this thread's machines are rolled out with those of others (`pool`)."""
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

    They may differ in everything. What takes a program of its own (`kind_of`) goes with its like; machines with
    probes, and laws of more than `MOST_TERMS` terms, are driven alone.

    Args:
        runs: machines, and what each is driven with.
        at_once: compile what is not compiled yet, and wait for it; else the machines are driven one by one until that
            is done (`lane_compiling`).

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
            groups.setdefault(kind_of(run.joint, run.spool_steps, law), []).append(i)
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
        runs: machines without probes, and what each is driven with.
        laws: of each, with that of its record.
    """
    lanes = [*runs, *[runs[-1]] * (LANES - len(runs))]
    joints = np.empty(LANES, dtype=JOINT)
    for lane, run in enumerate(lanes):
        joints[lane] = run.joint[0]
    commands = [_changes(run.command_times, run.command_values) for run in lanes]
    for run in runs:
        check_times(run.command_times, run.command_values, run.times)
    rows = np.array([len(run.times) for run in lanes])
    pulls = any(run.pull is not None for run in runs)
    measured = np.full((LANES, int(rows.max()) if pulls else 0, len(kernel.PULLED)), np.nan)
    for lane, run in enumerate(lanes):
        if run.pull is not None:
            measured[lane, : rows[lane]] = run.pull[1]
    terms, numbers = None, flat(joints)
    if kind.terms:
        own = [law for law in laws if law is not None]
        terms = np.stack([_filled_up(law, kind.terms) for law in (*own, *[own[-1]] * (LANES - len(own)))])
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
        _side_by_side([times for times, _ in commands], np.inf),
        _side_by_side([values for _, values in commands], np.nan),
        _side_by_side([run.times for run in lanes], np.nan),
        rows,
        np.array([run.longest_step for run in lanes]),
        max(
            _most_steps(run.times, times, run.longest_step)
            for run, (times, _) in zip(runs, commands, strict=False)
        ),
        np.array([0.0 if run.pull is None else run.pull[0] for run in lanes]),
        measured,
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


def _side_by_side(series: Sequence[np.ndarray], behind: float) -> np.ndarray:
    """Series of different lengths in rows, filled up with a value."""
    rows = np.full((len(series), max(map(len, series))), behind)
    for row, values in zip(rows, series, strict=True):
        row[: len(values)] = values
    return rows


def _filled_up(law: np.ndarray, count: int) -> np.ndarray:
    """A law with terms of no size. # (k,) -> (count,)."""
    terms = np.ones(count, dtype=LAW)  # what divides is not zero
    for name in ("sine", "cosine", "frequency", "probe", "time", "place", "speed_shape", "other"):
        terms[name] = 0.0
    terms[: len(law)] = law
    return terms


def _in_lanes(run: Run, law: np.ndarray | None) -> bool:
    """Whether there can be a loop over lanes for a machine."""
    few = law is None or len(law) <= MOST_TERMS
    return run.probes is None and few and missing_number(run.joint) is None


def compiled_kind_of(run: Run, law: np.ndarray | None) -> Kind | None:
    """The kind of a machine, if its loop over lanes is compiled; else it goes alone, and counts for when it will be.

    Args:
        run: the machine.
        law: with that of its record.
    """
    if not _in_lanes(run, law):
        return None
    kind = kind_of(run.joint, run.spool_steps, law)
    return kind if ready(kind, run.joint, law, 1, run.spool_steps) else None


def kind_of(joint: np.ndarray, spool_steps: int, law: np.ndarray | None = None) -> Kind:
    """What of a machine is known when a loop over lanes is compiled.

    Args:
        joint: its record, shape (1,).
        spool_steps: as of `roll_out`.
        law: how inputs from outside follow from the state, rows of `law.LAW`, or None.
    """
    numbers = flat(joint)[0]
    variants, groups, sometimes = _places()
    known = {place: float(numbers[place]) for place in variants}
    for sizes, places in groups:
        if all(numbers[size] == neutral for size, neutral in sizes):
            known |= {place: float(neutral) for place, neutral in places}
    known |= {place: 0.0 for place in sometimes if not numbers[place] > 0.0}
    steps = int(steps_needed(spool_steps, joint[0]))
    if law is None:
        return Kind(tuple(sorted(known.items())), steps)
    terms = next(count for count in TERMS if count >= len(law))
    return Kind(tuple(sorted(known.items())), steps, terms, bool(acts_early(law, joint[0])))


_Places = tuple[tuple[int, float], ...]


@cache
def _places() -> tuple[tuple[int, ...], tuple[tuple[_Places, _Places], ...], tuple[int, ...]]:
    """Places in a flat record: of variants; of each group: sizes, and all numbers, with neutral values; others."""
    variants = tuple(position_of(stage, "variant") for stage in STAGES)
    groups = []
    for hooks in GROUPS:
        effects = [effect for effect in EFFECTS.values() if any(hook in effect.hooks for hook in hooks)]
        sizes = tuple((position_of(e.key, e.size), e.neutral_size) for e in effects)
        numbers = tuple(
            (position_of(e.key, p.name), float(p.neutral or 0.0)) for e in effects for p in e.parameters
        )
        groups.append((sizes, numbers))
    sometimes = tuple(position_of(*path.split(".")) for path in SOMETIMES)
    return variants, tuple(groups), sometimes


def _most_steps(times: np.ndarray, moments: np.ndarray, longest_step: float) -> int:
    """At least as many steps as any machine takes between two of `times`: each command that arrives adds one."""
    if len(times) < 2:
        return 1
    longest = float(np.diff(times).max())
    within = np.searchsorted(moments, moments + longest, side="right") - np.arange(len(moments))
    return int(np.ceil(longest / longest_step)) + int(within.max()) + 2
