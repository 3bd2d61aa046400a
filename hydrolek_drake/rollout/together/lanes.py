"""Many machines whose joints move together, rolled out in lanes: the front door of `lane_kernel`."""

import os
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.physics.bodies.serial_arm import scratch
from hydrolek_drake.physics.law import LAW, MOST_TERMS
from hydrolek_drake.physics.probes import SUPPLY
from hydrolek_drake.physics.records import flat
from hydrolek_drake.rollout.lanes.compiling import compiled, ready
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.lanes.lanes import FEW, OFF, SWITCH
from hydrolek_drake.rollout.lanes.table import filled_up, side_by_side
from hydrolek_drake.rollout.lanes.view import LANES, NUMBERS, Kind
from hydrolek_drake.rollout.rest import rest_state
from hydrolek_drake.rollout.together.arms import NO_LINKS
from hydrolek_drake.rollout.together.joint_rows import room
from hydrolek_drake.rollout.together.kernel import TOLD
from hydrolek_drake.rollout.together.lane_kernel import integrate_together_lanes
from hydrolek_drake.rollout.together.lane_programs import BLOCK, NUMBERS_OF_JOINT, TERMS, programs_of
from hydrolek_drake.rollout.together.together import RunTogether, Together, put_begun

Kinds = tuple[Kind, ...]
"""Of the joints of a machine."""


def roll_out_together(runs: Sequence[RunTogether], *, at_once: bool = False) -> list[Together]:
    """Drive several machines side by side; each does what it does alone (`RunTogether.outcome`), to the last bit.

    Machines with the same links and joints of the same kinds (`kind_of`) go together, whatever their numbers, commands,
    times and steps. One by one go those with a law for the supply, which all joints feel.

    Args:
        runs: machines, and what each is driven with.
        at_once: compile what is not compiled yet, and wait for it; else the machines are driven one by one until that
            is done (`lanes.compiling`).

    Returns:
        What each of them did, in their order. One that diverges disturbs no other.
    """
    if not at_once and (len(runs) <= FEW or os.environ.get(SWITCH) == OFF):
        return [run.outcome() for run in runs]
    found: dict[int, Together] = {}
    groups: dict[tuple[Kinds, bytes], list[int]] = {}
    for i, run in enumerate(runs):
        if _in_lanes(run):
            groups.setdefault((kinds_of(run), run.links.tobytes()), []).append(i)
        else:
            found[i] = run.outcome()
    for (kinds, _), members in groups.items():
        if at_once or (len(members) > FEW and _ready(kinds, runs[members[0]], len(members))):
            alike = sorted(members, key=lambda i: (len(runs[i].times), runs[i].longest_step))
            for at in range(0, len(alike), LANES):
                chosen = alike[at : at + LANES]
                found |= dict(zip(chosen, one_table(kinds, [runs[i] for i in chosen]), strict=True))
            for kind in set(kinds):
                compiled(kind)
        else:
            found |= {i: runs[i].outcome() for i in members}
    return [found[i] for i in range(len(runs))]


def kinds_of(run: RunTogether) -> Kinds:
    """The kind of each joint."""
    laws = [law if len(law) else None for law in run.laws]
    return tuple(
        replace(kind_of(run.records[i : i + 1], run.spool_steps, law), together=True)
        for i, law in enumerate(laws)
    )


def one_table(kinds: Kinds, runs: Sequence[RunTogether]) -> list[Together]:
    """At most `LANES` machines of the same kinds; lanes that are left do what the last one does.

    Args:
        kinds: of their joints.
        runs: machines that can begin, with the same links.
    """
    lanes = [*runs, *[runs[-1]] * (LANES - len(runs))]
    joints = np.stack([run.records for run in lanes])
    n, rows = len(kinds), np.array([len(run.times) for run in lanes])
    table = _aligned((n, BLOCK, LANES))
    numbers = flat(joints.reshape(-1)).reshape(LANES, n, NUMBERS)
    table[:, NUMBERS_OF_JOINT : NUMBERS_OF_JOINT + NUMBERS] = np.moveaxis(numbers, 0, 2)
    put_begun(table, np.stack([run.begun for run in lanes if run.begun is not None], axis=2))
    terms = np.array([kind.terms for kind in kinds])
    laws = np.zeros((LANES, n, max(int(terms.max()), 1)), dtype=LAW)
    for lane, run in enumerate(lanes):
        for i, count in enumerate(terms.tolist()):
            if count:
                laws[lane, i, :count] = filled_up(run.laws[i], count)
                own = laws[lane, i, :count].view(np.float64).ravel()
                table[i, TERMS : TERMS + own.size, lane] = own
    out = np.full((LANES, int(rows.max()), n, len(TOLD)), np.nan)
    done = np.zeros(LANES, dtype=np.int64)
    _, vectors, matrices = room(n)
    integrate_together_lanes(
        np.array([programs_of(kind) for kind in kinds]),
        joints,
        np.stack([run.carriers for run in lanes]),
        laws,
        terms,
        table,
        _aligned((*vectors.shape, LANES)),
        _aligned((*matrices.shape, LANES)),
        _aligned((*scratch(len(runs[0].links)).shape, LANES)),
        runs[0].links,
        side_by_side([run.command_times for run in lanes], np.inf),
        side_by_side([run.command_values for run in lanes], np.nan),
        side_by_side([run.times for run in lanes], np.nan),
        rows,
        np.array([run.longest_step for run in lanes]),
        out,
        done,
    )
    return [run.told(out[lane, : rows[lane]], int(done[lane])) for lane, run in enumerate(runs)]


def compile_for(joint: np.ndarray, law: np.ndarray | None, spool_steps: int) -> None:
    """Compile what machines with joints of a kind need.

    Args:
        joint: record of one of them, shape (1,).
        law: of that one, rows of `law.LAW`, or None.
        spool_steps: as of `roll_out`.
    """
    step = 1e-3
    times = np.array([0.0, step])
    laws = (np.zeros(0, LAW) if law is None else law,)
    rest = rest_state(joint)[None]
    run = RunTogether(
        ("joint",), NO_LINKS, joint, joint, laws, rest, times, np.zeros((2, 1)), times, step, spool_steps
    )
    roll_out_together([run], at_once=True)


def _aligned(shape: tuple[int, ...]) -> np.ndarray:
    """Zeros that begin where a line of the processor's cache does: no row of lanes lies in two of them."""
    size, line = int(np.prod(shape)), 8 * LANES
    room = np.zeros(size + LANES)
    begin = (-room.ctypes.data % line) // 8
    return room[begin : begin + size].reshape(shape)


def _in_lanes(run: RunTogether) -> bool:
    """Whether there can be loops over lanes for a machine."""
    alone = any(len(law) > MOST_TERMS or np.any(law["probe"] == SUPPLY) for law in run.laws)
    return run.begun is not None and run.recorded is None and not alone


def _ready(kinds: Kinds, run: RunTogether, count: int) -> bool:
    """Whether the loops of all kinds are there; what is not is compiled beside the work once it has become worth it."""
    firsts = {kind: i for i, kind in reversed(list(enumerate(kinds)))}
    return all(
        [
            ready(
                kind,
                run.records[i : i + 1],
                run.laws[i] if len(run.laws[i]) else None,
                count,
                run.spool_steps,
            )
            for kind, i in firsts.items()
        ]
    )
