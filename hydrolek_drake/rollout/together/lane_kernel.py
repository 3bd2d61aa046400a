"""Joints that move together of several machines in lanes: the loop of `kernel`, stepped in lockstep.

What a joint does by itself are loops over lanes of its kind (`lane_programs`), the arms' equation of motion is
that of one machine, compiled for a number of each lane (`lanes.numbers`). Machines have their own commands, moments at
which these arrive, and times at which signals are wanted; one that needs fewer steps than another between two rows, or
has ended, stands still for the rest.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, load
from hydrolek_drake.physics.probes import no_probe
from hydrolek_drake.rollout.kernel import inertia_at, out_of_bounds, written
from hydrolek_drake.rollout.lanes.numbers import lane_array, lane_rows
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.rates import kept, turned
from hydrolek_drake.rollout.stretches import arrived
from hydrolek_drake.rollout.together.joint_rows import (
    BIAS,
    COMMAND,
    MASS,
    MIDDLE,
    PAYLOAD,
    PLAY,
    ROD,
    STATE,
    THERE,
    TORQUE,
    drive_at,
    near_at,
    put_near,
    state_at,
)
from hydrolek_drake.rollout.together.kernel import DRAWN_TOLD, next_stretch_of_all, put_payloads
from hydrolek_drake.rollout.together.lane_programs import BLOCK, TIME, H, call_program
from hydrolek_drake.rollout.together.rates import arm_begins, arm_equation, arm_goes_on, drawn_by_all

_L = LANES


@njit
def _steps_on(
    programs: np.ndarray,
    b: np.ndarray,
    vectors: np.ndarray,
    matrices: np.ndarray,
    scratch: np.ndarray,
    links: np.ndarray,
    carriers: np.ndarray,
) -> None:
    """One step of all joints of all machines."""
    n = len(programs)
    flat = b.reshape(b.size)
    r, v, m, s = lane_array(b), lane_array(vectors), lane_array(matrices), lane_array(scratch)
    for i in range(n):
        call_program(programs[i, 0], flat, i * BLOCK * _L)
    drawn_by_all(r)
    if len(links) > 0:
        for lane in range(_L):
            put_payloads(vectors[PAYLOAD, :, lane], links, carriers[lane], b[0, TIME, lane])
        arm_equation(r, STATE, v, m[MASS], links, s)
        arm_begins(r, v[TORQUE], m, links, r[0, H])
    for i in range(n):
        call_program(programs[i, 1], flat, i * BLOCK * _L)
    drawn_by_all(r)
    if len(links) > 0:
        for lane in range(_L):
            put_payloads(vectors[PAYLOAD, :, lane], links, carriers[lane], b[0, TIME, lane] + b[0, H, lane])
        arm_equation(r, MIDDLE, v, m[THERE], links, s)
        arm_goes_on(r, v[TORQUE], v[BIAS], m, links)
    for i in range(n):
        call_program(programs[i, 2], flat, i * BLOCK * _L)


@njit(cache=True, nogil=True)
def integrate_together_lanes(
    programs: np.ndarray,
    joints: np.ndarray,
    carriers: np.ndarray,
    laws: np.ndarray,
    terms: np.ndarray,
    b: np.ndarray,
    vectors: np.ndarray,
    matrices: np.ndarray,
    scratch: np.ndarray,
    links: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    rows: np.ndarray,
    longest_step: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
) -> None:
    """Integrate `LANES` machines, each through its commands, and write their signals, each at its times.

    Args:
        programs: of each joint, see `programs_of`. # (n, 3)
        joints: parameter records. # (lanes, n)
        carriers: records that say what hangs on each link. # (lanes, n)
        laws: terms of each joint's law, rows of `law.LAW`. # (lanes, n, terms)
        terms: how many of these a joint has. # (n,)
        b: the table, see `lane_programs`, with the joints' numbers, `STATE`, `DRIVE` and `PLAY`.
            # (n, BLOCK, lanes)
        vectors: room of `joint_rows`, of each lane. # (6, n, lanes)
        matrices: the same. # (3, n, n, lanes)
        scratch: of `serial_arm`, of each lane. # (links, 46, lanes)
        links: as of `integrate_together`.
        command_times: [s], infinite behind the last one. # (lanes, m)
        command_values: [V]. # (lanes, m, n)
        times: when to write [s]. # (lanes, k)
        rows: how many of these there are. # (lanes,)
        longest_step: [s]. # (lanes,)
        out: `TOLD`. # (lanes, k, n, 9)
        done: rows written of each machine; fewer than its `rows` where one diverged at that row. # (lanes,)
    """
    n = len(programs)
    flat = b.reshape(b.size)
    held, delays = np.full((_L, n), -1), np.zeros((_L, n))
    now, begun, size = times[:, 0].copy(), np.zeros(_L), np.zeros(_L)
    left, taken = np.zeros(_L, np.int64), np.zeros(_L, np.int64)
    for lane in range(_L):
        r = lane_rows(flat, BLOCK, lane)
        for i in range(n):
            r[i, ROD] = load.reflected_rod_inertia(joints[lane, i])
            delays[lane, i] = command.transport_delay(joints[lane, i])
        done[lane] = rows[lane]
    for row in range(rows.max()):
        for lane in range(_L):
            r = lane_rows(flat, BLOCK, lane)
            for i in range(n):
                put_near(r, i, kept(turned(state_at(r, i, STATE), joints[lane, i])))
        while True:
            some = False
            for lane in range(_L):
                r = lane_rows(flat, BLOCK, lane)
                if row < rows[lane] and done[lane] == rows[lane]:
                    while left[lane] == 0 and now[lane] < times[lane, row]:
                        t = now[lane]
                        now[lane], steps, h = next_stretch_of_all(
                            t,
                            times[lane, row],
                            held[lane],
                            delays[lane],
                            command_times[lane],
                            command_values[lane],
                            longest_step[lane],
                        )
                        for i in range(n):
                            r[i, COMMAND] = arrived(
                                command_values[lane, :, i], held[lane, i], joints[lane, i]
                            )
                        if h > 0.0:
                            begun[lane], size[lane], left[lane], taken[lane] = t, h, steps, 0
                h = 0.0
                if left[lane] > 0:
                    h, some = size[lane], True
                time = begun[lane] + taken[lane] * h - times[lane, 0]
                for i in range(n):
                    r[i, H], r[i, TIME] = h, time
                if left[lane] > 0:
                    left[lane] -= 1
                    taken[lane] += 1
            if not some:
                break
            _steps_on(programs, b, vectors, matrices, scratch, links, carriers)
        for lane in range(_L):
            if row < rows[lane] and done[lane] == rows[lane]:
                _write(
                    lane_rows(flat, BLOCK, lane), now[lane] - times[lane, 0], row, joints[lane], laws[lane],
                    terms, command_values[lane], held[lane], out[lane], done, lane,
                )  # fmt: skip


@njit
def _write(
    r: Any,
    time: float,
    row: int,
    joints: np.ndarray,
    laws: np.ndarray,
    terms: np.ndarray,
    command_values: np.ndarray,
    held: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
    lane: int,
) -> None:
    """Write a row of one machine, or that it has diverged there."""
    for i in range(len(joints)):
        joint, s, d = joints[i], state_at(r, i, STATE), drive_at(r, i)
        if out_of_bounds(d.x, s):
            done[lane] = row
            return
        inertia = inertia_at(time, r[i, ROD], joint)
        volts = arrived(command_values[:, i], held[i], joint)
        told, near, play, outside = out[row, i], near_at(r, i), r[i, PLAY], no_probe()
        if terms[i] > 0:
            law = laws[i, : terms[i]]
            told[DRAWN_TOLD] = written(
                d, s, play, volts, time, inertia, outside, law, near, None, joint, told
            )
        else:
            told[DRAWN_TOLD] = written(
                d, s, play, volts, time, inertia, outside, None, near, None, joint, told
            )
