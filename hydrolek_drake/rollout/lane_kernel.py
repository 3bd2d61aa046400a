"""Machines in lanes: the chain of `kernel`, stepped in lockstep, with the lanes as the innermost loop.

Each machine has its own moments at which commands arrive, and so its own steps between two rows of signals; a lane that
needs fewer than another stands still for the rest. No lane reads what another one writes.
"""

import math
from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, hooks, load, sensor
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.probes import no_probe
from hydrolek_drake.rollout.drive import Drive, driven_on
from hydrolek_drake.rollout.kernel import (
    arrived,
    inertia_at,
    one_step,
    out_of_bounds,
    pulled,
    written,
)
from hydrolek_drake.rollout.lane_table import (
    KEPT,
    NEAR,
    NEAR_NEXT,
    NEXT,
    NUMBERS_OF_JOINT,
    ROD,
    ROWS,
    STATE,
    TIME,
    VOLTS,
    H,
    drive_in,
    near_in,
    put,
    put_near,
    state_in,
)
from hydrolek_drake.rollout.lane_view import LANES, NUMBERS, lane_joint, spool_steps_of
from hydrolek_drake.rollout.rates import State, carried_on, turned

_L = LANES


@njit
def planned(
    target: float,
    begin: float,
    held: int,
    delay: float,
    command_times: np.ndarray,
    command_values: np.ndarray,
    longest_step: float,
    lane: int,
    steps: np.ndarray,
    joint: Any,
) -> tuple[int, int]:
    """Steps of one machine from `begin` to `target`, ending where a command arrives.

    Args:
        target: [s].
        begin: [s].
        held: place of the command that acts, -1 for none.
        delay: of the commands [s].
        command_times: [s], shape (m,).
        command_values: [V], shape (m,).
        longest_step: [s].
        lane: of the machine.
        steps: receives length [s], command [V] and beginning [s] of each step, shape (k, 3, lanes).
        joint: its record.

    Returns:
        How many steps, and the command that acts at the end.
    """
    last = len(command_times) - 1
    t, count = begin, 0
    while t < target:
        while held < last and command_times[held + 1] + delay <= t + 1e-12:
            held += 1
        following = held + 1
        while held >= 0 and following <= last and command_values[following] == command_values[held]:
            following += 1
        until = target
        if following <= last and command_times[following] + delay < target:
            until = max(command_times[following] + delay, t)
        volts = arrived(command_values, held, joint)
        number = max(math.ceil((until - t) / longest_step - 1e-9), 1)
        h = (until - t) / number
        if h > 0.0:
            for i in range(number):
                steps[count, 0, lane], steps[count, 1, lane], steps[count, 2, lane] = h, volts, t + i * h
                count += 1
        t = until
    return count, held


@njit
def _all_lanes(kind: Any, b: np.ndarray) -> None:
    """One step of every machine, from the rows of `STATE` to those of `NEXT`."""
    _loop(kind, b)  # inlined here alone, so that it is not optimised again with all that calls this


@njit(
    forceinline=True
)  # and with it all that it calls: a call that is left keeps the loop from vector instructions
def _loop(kind: Any, b: np.ndarray) -> None:
    probe = no_probe()
    for lane in range(_L):
        joint = lane_joint(kind, b, NUMBERS_OF_JOINT * _L + lane)
        s, d, play = state_in(b, STATE, lane), drive_in(b, STATE, lane), b[(STATE + 14) * _L + lane]
        near = near_in(b, NEAR, lane)
        h, volts, time = b[H * _L + lane], b[VOLTS * _L + lane], b[TIME * _L + lane]
        voltage = command.drive_voltage(volts, joint)
        e, drive = driven_on(
            d, s, volts, voltage, time, h, spool_steps_of(kind), False, probe, probe, None, joint
        )
        inertia = inertia_at(time, b[ROD * _L + lane], joint)
        n = one_step(s, d.x, e.x, drive, time, h, inertia, probe, probe, None, near, joint)
        played = sensor.played(play, n.q - n.tilt, joint)
        after = carried_on(near, n, joint)
        position, included = after.position, after.included
        f, g, go = NEXT * _L + lane, NEAR_NEXT * _L + lane, h > 0.0
        b[f] = n.p_a if go else s.p_a
        b[f + _L] = n.p_b if go else s.p_b
        b[f + 2 * _L] = n.q if go else s.q
        b[f + 3 * _L] = n.w if go else s.w
        b[f + 4 * _L] = n.flow if go else s.flow
        b[f + 5 * _L] = n.tilt if go else s.tilt
        b[f + 6 * _L] = n.tilt_rate if go else s.tilt_rate
        b[f + 7 * _L] = n.lead_q if go else s.lead_q
        b[f + 8 * _L] = n.lead_w if go else s.lead_w
        b[f + 9 * _L] = e.x if go else d.x
        b[f + 10 * _L] = e.xd if go else d.xd
        b[f + 11 * _L] = e.behind if go else d.behind
        b[f + 12 * _L] = e.currents.a if go else d.currents.a
        b[f + 13 * _L] = e.currents.b if go else d.currents.b
        b[f + 14 * _L] = played if go else play
        b[g] = position.value if go else near.position.value
        b[g + _L] = position.sine if go else near.position.sine
        b[g + 2 * _L] = position.cosine if go else near.position.cosine
        b[g + 3 * _L] = included.value if go else near.included.value
        b[g + 4 * _L] = included.sine if go else near.included.sine
        b[g + 5 * _L] = included.cosine if go else near.included.cosine


@njit(cache=True, nogil=True)
def integrate_lanes(
    kind: Any,
    joints: np.ndarray,
    numbers: np.ndarray,
    states: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    longest_step: float,
    most_steps: int,
    pull_time: float,
    measured: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
) -> None:
    """Integrate `LANES` joints through one command and write their signals at `times`.

    Args:
        kind: what is alike in all lanes, a `Kind`.
        joints: their records, shape (lanes,).
        numbers: the same as numbers, shape (lanes, n).
        states: see `kernel.integrate`, shape (lanes, 16); hold the final states afterwards.
        command_times: [s], shape (m,).
        command_values: [V], shape (m,).
        times: when to write [s], shape (k,).
        longest_step: [s].
        most_steps: at least as many as any machine takes between two of `times`.
        pull_time: as of `kernel.integrate` [s].
        measured: as of `kernel.integrate`, shape (k, 3).
        out: signals, shape (lanes, k, 8).
        done: rows written of each machine, shape (lanes,); fewer than k where one diverged at that row.
    """
    b, machines = np.zeros(ROWS * _L), np.zeros((_L, 2))
    held, steps = np.full(_L, -1), np.zeros((most_steps, 3, _L))
    _enter(joints, numbers, states, times[0], b, machines)
    done[:] = len(times)
    t = times[0]
    for row in range(len(times)):
        most = _plan(
            joints, t, times[row], machines, command_times, command_values, longest_step, b, held, steps
        )
        for i in range(most):
            b[H * _L : (H + 3) * _L] = steps[i].ravel()
            _all_lanes(kind, b)
            b[STATE * _L : (STATE + KEPT) * _L] = b[NEXT * _L : (NEXT + KEPT) * _L]
            b[NEAR * _L : (NEAR + 6) * _L] = b[NEAR_NEXT * _L : (NEAR_NEXT + 6) * _L]
        t = times[row]
        until = times[row + 1] - t if row + 1 < len(times) else 0.0
        share = 1.0 - math.exp(-until / pull_time) if pull_time > 0.0 and until > 0.0 else 0.0
        _write(joints, t, row, len(times), machines, command_values, held, share, measured, b, out, done)
    _leave(joints, times[-1], machines, b, states)


@njit(cache=True)
def _enter(
    joints: np.ndarray,
    numbers: np.ndarray,
    states: np.ndarray,
    begin: float,
    b: np.ndarray,
    machines: np.ndarray,
) -> None:
    """Put the machines' numbers and states into the table, and when each was switched on and its delay beside."""
    for lane in range(_L):
        joint, v = joints[lane], states[lane]
        for i in range(NUMBERS):
            b[(NUMBERS_OF_JOINT + i) * _L + lane] = numbers[lane, i]
        s = State(v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10])
        put(b, STATE, lane, s, Drive(v[13], Currents(v[14], v[15]), v[0], v[1]), v[11])
        b[ROD * _L + lane] = load.reflected_rod_inertia(joint)
        machines[lane, 0], machines[lane, 1] = begin - v[12], command.transport_delay(joint)


@njit(cache=True)
def _plan(
    joints: np.ndarray,
    begin: float,
    target: float,
    machines: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    longest_step: float,
    b: np.ndarray,
    held: np.ndarray,
    steps: np.ndarray,
) -> int:
    """Steps of all machines up to the next row, see `planned`: as many as that takes which needs most."""
    most, count = 0, np.zeros(_L, np.int64)
    for lane in range(_L):
        joint = joints[lane]
        put_near(b, NEAR, lane, turned(state_in(b, STATE, lane), joint))
        count[lane], held[lane] = planned(
            target,
            begin,
            held[lane],
            machines[lane, 1],
            command_times,
            command_values,
            longest_step,
            lane,
            steps,
            joint,
        )
        most = max(most, count[lane])
        for i in range(count[lane]):
            steps[i, 2, lane] -= machines[lane, 0]
    for lane in range(_L):
        for i in range(count[lane], most):
            steps[i, 0, lane] = 0.0
    return most


@njit(cache=True)
def _write(
    joints: np.ndarray,
    t: float,
    row: int,
    rows: int,
    machines: np.ndarray,
    command_values: np.ndarray,
    held: np.ndarray,
    share: float,
    measured: np.ndarray,
    b: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
) -> None:
    """Write a row of every machine that has not diverged, and pull them to what was measured by a share."""
    for lane in range(_L):
        joint = joints[lane]
        s, d, play = state_in(b, STATE, lane), drive_in(b, STATE, lane), b[(STATE + 14) * _L + lane]
        if done[lane] < rows:
            continue
        if out_of_bounds(d.x, s):
            done[lane] = row
            continue
        time = t - machines[lane, 0]
        volts = arrived(command_values, held[lane], joint)
        inertia = inertia_at(time, b[ROD * _L + lane], joint)
        written(
            d, s, play, volts, time, inertia, no_probe(), None, near_in(b, NEAR, lane), joint, out[lane, row]
        )
        if share > 0.0:
            s, by = pulled(s, share, out[lane, row, 0], measured[row])
            put(b, STATE, lane, s, d, play + by)


@njit(cache=True)
def _leave(joints: np.ndarray, end: float, machines: np.ndarray, b: np.ndarray, states: np.ndarray) -> None:
    """The machines' final states."""
    for lane in range(_L):
        joint = joints[lane]
        s, d, v = state_in(b, STATE, lane), drive_in(b, STATE, lane), states[lane]
        playing, rocking = hooks.linkage_gap(joint) > 0.0, hooks.base_stiffness(joint) > 0.0
        v[0], v[1], v[2], v[3], v[4], v[5], v[6] = d.x, d.xd, s.p_a, s.p_b, s.q, s.w, s.flow
        v[7], v[8] = (s.tilt, s.tilt_rate) if rocking else (0.0, 0.0)
        v[9], v[10] = (s.lead_q, s.lead_w) if playing else (s.q, s.w)
        v[11], v[12] = b[(STATE + 14) * _L + lane], end - machines[lane, 0]
        v[13], v[14], v[15] = d.behind, d.currents.a, d.currents.b
