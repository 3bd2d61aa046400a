"""Many machines under one command, rolled out in lanes: the front door of `lane_kernel`."""

from collections.abc import Sequence
from functools import cache

import numpy as np

from hydrolek_drake.compiled import read_only
from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.physics.law import law_of
from hydrolek_drake.physics.records import STAGES, flat, position_of
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.rollout import kernel
from hydrolek_drake.rollout.lane_compiling import compiled, ready
from hydrolek_drake.rollout.lane_kernel import integrate_lanes
from hydrolek_drake.rollout.lane_view import LANES, Kind
from hydrolek_drake.rollout.rollout import (
    DIVIDED_BY_ZERO,
    STATE_SIZE,
    Outcome,
    Signals,
    check_times,
    missing_number,
    rest_state,
    roll_out,
    why_diverged,
)

GROUPS = (
    ("rod_friction", "load_friction"),
    ("coil_gain", "flow_gain", "viscous_gain"),
    ("spool_friction",),
    ("linkage_gap",),
    ("base_stiffness", "base_inertia"),
)
"""Hooks whose effects take time in every step, or make it another program. A loop over lanes is compiled with a group
or without it; what enters at other hooks costs little, and is a number that may be zero."""

SOMETIMES = ("command.ramp", "amplifier.coil_time", "valve.flow_force")
"""Parameters of the stages that most machines have at zero, and that cost as much."""


FEW = 2
"""So many machines take no longer one by one."""


def roll_out_lanes(
    joints: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    *,
    states: Sequence[np.ndarray] | None = None,
    longest_step: float,
    spool_steps: int = 1,
    pull: tuple[float, np.ndarray] | None = None,
    at_once: bool = False,
) -> list[Outcome]:
    """Drive several machines with one recorded command; each as `roll_out` would drive it alone, to the last bit.

    Args:
        joints: parameter records, shape (n,), dtype `physics.records.JOINT`.
        command_times: as of `roll_out`.
        command_values: as of `roll_out`.
        times: as of `roll_out`.
        states: where each one starts; None for rest at its own initial position.
        longest_step: as of `roll_out`.
        spool_steps: as of `roll_out`.
        pull: as of `roll_out`.
        at_once: compile what is not compiled yet, and wait for it; else the machines are driven one by one until that
            is done (`lane_compiling`).

    Returns:
        What each of them did, in their order. One that diverges disturbs no other.

    Raises:
        InputError: as of `roll_out`.
    """
    check_times(command_times, command_values, times)
    found: dict[int, Outcome] = {}
    groups: dict[Kind, list[int]] = {}
    alone: list[int] = []
    for i in range(len(joints)):
        joint = joints[i : i + 1]
        if law_of(joint) is not None or missing_number(joint) is not None:
            alone.append(i)
        else:
            groups.setdefault(kind_of(joint, spool_steps), []).append(i)
    for kind, members in list(groups.items()):
        first = members[0]
        if not at_once and (
            len(members) <= FEW or not ready(kind, joints[first : first + 1], len(members), spool_steps)
        ):
            alone += groups.pop(kind)
    for i in alone:
        found[i] = roll_out(
            joints[i : i + 1],
            command_times,
            command_values,
            times,
            state=None if states is None else states[i],
            longest_step=longest_step,
            spool_steps=spool_steps,
            pull=pull,
        )
    pull_time, measured = pull or (0.0, kernel.NOT_PULLED)
    changes = np.concatenate([[True], np.diff(command_values) != 0.0])
    moments, values = read_only(command_times[changes]), read_only(command_values[changes])
    wanted = read_only(times)
    most = _most_steps(wanted, moments, longest_step)
    for kind, members in groups.items():
        for first in range(0, len(members), LANES):
            chosen = members[first : first + LANES]
            full = chosen + [chosen[-1]] * (LANES - len(chosen))
            own = np.ascontiguousarray(joints[full])
            begun = np.empty((LANES, STATE_SIZE))
            for lane, i in enumerate(full):
                begun[lane] = rest_state(joints[i : i + 1]) if states is None else states[i]
            out = np.full((LANES, len(wanted), len(kernel.SIGNALS)), np.nan)
            done = np.zeros(LANES, dtype=np.int64)
            integrate_lanes(
                kind,
                own,
                flat(own),
                begun,
                moments,
                values,
                wanted,
                longest_step,
                most,
                pull_time,
                read_only(measured),
                out,
                done,
            )
            for lane, i in enumerate(chosen):
                rows = int(done[lane])
                diverged = None
                if rows < len(wanted):
                    diverged = why_diverged(joints[i : i + 1], float(wanted[rows]))
                    if diverged == DIVIDED_BY_ZERO:
                        out[lane] = np.nan
                found[i] = Outcome(Signals(wanted, *out[lane].T), diverged, begun[lane])
        compiled(kind)
    return [found[i] for i in range(len(joints))]


def kind_of(joint: np.ndarray, spool_steps: int) -> Kind:
    """What of a joint's record is known when a loop over lanes is compiled.

    Args:
        joint: its record, shape (1,).
        spool_steps: as of `roll_out`.
    """
    numbers = flat(joint)[0]
    variants, groups, sometimes = _places()
    known = {place: float(numbers[place]) for place in variants}
    for sizes, places in groups:
        if all(numbers[size] == neutral for size, neutral in sizes):
            known |= {place: float(neutral) for place, neutral in places}
    known |= {place: 0.0 for place in sometimes if not numbers[place] > 0.0}
    return Kind(tuple(sorted(known.items())), int(steps_needed(spool_steps, joint[0])))


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
