"""Machines in lanes: the chain of `rollout.kernel`, stepped in lockstep, with the lanes as the innermost loop.

Each machine has its own command, moments at which it arrives, and times at which signals are wanted, and so its own
steps between two rows of signals; a lane that needs fewer than another, or has ended, stands still for the rest. No
lane reads what another one writes.
"""

import math
from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, hooks, load, sensor
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.probes import no_probe, probe_at, sample_at
from hydrolek_drake.rollout.drive import Drive, driven_on
from hydrolek_drake.rollout.kernel import (
    inertia_at,
    out_of_bounds,
    pulled,
    written,
)
from hydrolek_drake.rollout.lanes.table import (
    COMMANDED,
    KEPT,
    NEAR,
    NEAR_NEXT,
    NEXT,
    NUMBERS_OF_JOINT,
    PLANNED,
    ROD,
    SAMPLE,
    SAMPLE_NEXT,
    SHARE,
    SHARE_NEXT,
    STATE,
    TERMS,
    TIME,
    VOLTS,
    H,
    drive_in,
    near_in,
    probe_in,
    put,
    put_near,
    put_sample,
    state_in,
)
from hydrolek_drake.rollout.lanes.view import (
    LANES,
    NUMBERS,
    early_of,
    lane_joint,
    lane_law,
    probed_of,
    spool_steps_of,
)
from hydrolek_drake.rollout.rates import State, carried_on, turned
from hydrolek_drake.rollout.rosenbrock import one_step
from hydrolek_drake.rollout.stretches import arrived, next_stretch

_L = LANES


@njit
def _all_lanes(kind: Any, b: np.ndarray) -> None:
    """One step of every machine, from the rows of `STATE` to those of `NEXT`."""
    _loop(kind, b)  # inlined here alone, so that it is not optimised again with all that calls this


@njit(
    forceinline=True
)  # and with it all that it calls: a call that is left keeps the loop from vector instructions
def _loop(kind: Any, b: np.ndarray) -> None:
    for lane in range(_L):
        joint = lane_joint(kind, b, NUMBERS_OF_JOINT * _L + lane)
        s, d, play = state_in(b, STATE, lane), drive_in(b, STATE, lane), b[(STATE + 14) * _L + lane]
        near = near_in(b, NEAR, lane)
        h, volts, time = b[H * _L + lane], b[VOLTS * _L + lane], b[TIME * _L + lane]
        probe = probe_next = no_probe()
        commanded = volts
        if probed_of(kind):
            probe, probe_next = probe_in(b, SAMPLE, SHARE, lane), probe_in(b, SAMPLE_NEXT, SHARE_NEXT, lane)
            commanded = b[COMMANDED * _L + lane]
        voltage = command.drive_voltage(commanded, joint)
        law = lane_law(kind, b, TERMS * _L + lane)
        e, drive = driven_on(
            d,
            s,
            volts,
            voltage,
            time,
            h,
            spool_steps_of(kind),
            early_of(kind),
            probe,
            probe_next,
            law,
            None,
            joint,
        )
        inertia = inertia_at(time, b[ROD * _L + lane], joint)
        n = one_step(s, d.x, e.x, drive, time, h, inertia, probe, probe_next, law, near, None, joint)
        played = sensor.played(play, n.q - n.tilt, joint)
        after = carried_on(near, n, joint)
        position, included = after.position, after.included
        f, g, go = NEXT * _L + lane, NEAR_NEXT * _L + lane, h > 0.0
        b[f] = n.p_a if go else s.p_a
        b[f + _L] = n.p_b if go else s.p_b
        b[f + 2 * _L] = n.q if go else s.q
        b[f + 3 * _L] = n.w if go else s.w
        b[f + 4 * _L] = n.supply if go else s.supply
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
        b[f + 15 * _L] = n.relief if go else s.relief
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
    laws: np.ndarray | None,
    states: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    rows: np.ndarray,
    longest_step: np.ndarray,
    most_steps: int,
    pull_time: np.ndarray,
    measured: np.ndarray,
    probe_spacing: np.ndarray,
    probe_places: np.ndarray,
    probe_values: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
) -> None:
    """Integrate `LANES` joints, each through its command, and write their signals, each at its times.

    Args:
        kind: what is alike in all lanes, a `Kind`.
        joints: their records, shape (lanes,).
        numbers: the same as numbers, shape (lanes, n).
        laws: terms of their laws, rows of `law.LAW`, shape (lanes, terms); None without.
        states: see `rollout.kernel.integrate`, shape (lanes, 17); hold the final states afterwards.
        command_times: [s], infinite behind the last one, shape (lanes, m).
        command_values: [V], NaN there, shape (lanes, m).
        times: when to write [s], shape (lanes, k).
        rows: how many of these there are, shape (lanes,).
        longest_step: [s], shape (lanes,).
        most_steps: at least as many as any machine takes between two of its times.
        pull_time: as of `rollout.kernel.integrate` [s], shape (lanes,).
        measured: as of `rollout.kernel.integrate`, shape (lanes, k, 3), or (lanes, 0, 3) where none is pulled.
        probe_spacing: as of `rollout.kernel.integrate` [s], shape (lanes,).
        probe_places: where the samples of each machine's inputs from outside begin among all, and how many it has,
            shape (lanes, 2).
        probe_values: samples, shape (all, 15); no rows without such inputs.
        out: signals, shape (lanes, k, 9).
        done: rows written of each machine, shape (lanes,); fewer than its `rows` where one diverged at that row.
    """
    machines, held, steps = np.zeros((_L, 2)), np.full(_L, -1), np.zeros((most_steps, PLANNED, _L))
    told = 3  # rows of these that a step takes
    samples, loaded = np.zeros((most_steps, 2, _L), np.int64), np.full((2, _L), -1)
    if probed_of(kind):
        told = PLANNED
    b = _entered(joints, numbers, laws, states, times, machines)
    done[:] = rows
    for row in range(rows.max()):
        most = _plan(
            joints, row, rows, times, machines, command_times, command_values, longest_step, b,
            held, steps, probe_spacing, probe_places, probe_values, samples,
        )  # fmt: skip
        for i in range(most):
            b[H * _L : (H + told) * _L] = steps[i, :told].ravel()
            if probed_of(kind):
                _load_samples(b, samples[i], loaded, probe_values)
            _all_lanes(kind, b)
            b[STATE * _L : (STATE + KEPT) * _L] = b[NEXT * _L : (NEXT + KEPT) * _L]
            b[NEAR * _L : (NEAR + 6) * _L] = b[NEAR_NEXT * _L : (NEAR_NEXT + 6) * _L]
        _write(
            joints, laws, row, rows, times, machines, command_values, held, pull_time, measured,
            probe_spacing, probe_places, probe_values, b, out, done,
        )  # fmt: skip
    _leave(joints, times, rows, machines, b, states)


@njit(cache=True)
def _entered(
    joints: np.ndarray,
    numbers: np.ndarray,
    laws: np.ndarray | None,
    states: np.ndarray,
    times: np.ndarray,
    machines: np.ndarray,
) -> np.ndarray:
    """The table with the machines' numbers and states; when each was switched on, and its delay, in `machines`."""
    b = np.zeros((TERMS + numbers.shape[1] - NUMBERS) * _L)
    for lane in range(_L):
        joint, v = joints[lane], states[lane]
        for i in range(numbers.shape[1]):
            b[(NUMBERS_OF_JOINT + i) * _L + lane] = numbers[lane, i]
        s = State(v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[16])
        put(b, STATE, lane, s, Drive(v[13], Currents(v[14], v[15]), v[0], v[1]), v[11])
        b[ROD * _L + lane] = load.reflected_rod_inertia(joint)
        machines[lane, 0], machines[lane, 1] = times[lane, 0] - v[12], command.transport_delay(joint)
    return b


@njit(cache=True)
def _plan(
    joints: np.ndarray,
    row: int,
    rows: np.ndarray,
    times: np.ndarray,
    machines: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    longest_step: np.ndarray,
    b: np.ndarray,
    held: np.ndarray,
    steps: np.ndarray,
    probe_spacing: np.ndarray,
    probe_places: np.ndarray,
    probe_values: np.ndarray,
    samples: np.ndarray,
) -> int:
    """Steps of all machines up to their next row: as many as that takes which needs most.

    What the table holds of a step, from `H` on, is written to `steps`, shape (k, 6, lanes), and which samples of inputs
    from outside come before its begin and its end, among all, to `samples`, shape (k, 2, lanes).
    """
    most, count = 0, np.zeros(_L, np.int64)
    for lane in range(_L):
        joint = joints[lane]
        put_near(b, NEAR, lane, turned(state_in(b, STATE, lane), joint))
        if not 0 < row < rows[lane]:
            continue
        t, target = times[lane, row - 1], times[lane, row]
        while t < target:
            stretch = next_stretch(
                t,
                target,
                held[lane],
                machines[lane, 1],
                command_times[lane],
                command_values[lane],
                longest_step[lane],
                joint,
            )
            held[lane] = stretch.held
            first, many = probe_places[lane]
            begin, spacing = times[lane, 0], probe_spacing[lane]
            if stretch.h > 0.0:
                added = 0.0
                if many > 0:
                    added = probe_at(t, begin, spacing, probe_values[first : first + many]).command
                for i in range(stretch.steps):
                    k = count[lane]
                    steps[k, 3, lane] = stretch.volts + added
                    if many > 0:
                        for end in range(2):
                            at, share = sample_at(t + (i + end) * stretch.h, begin, spacing, many)
                            samples[k, end, lane], steps[k, 4 + end, lane] = first + at, share
                    steps[k, 0, lane], steps[k, 1, lane] = stretch.h, stretch.volts
                    steps[k, 2, lane] = t + i * stretch.h - machines[lane, 0]
                    count[lane] += 1
            t = stretch.until
        most = max(most, count[lane])
    for lane in range(_L):
        for i in range(count[lane], most):
            steps[i, 0, lane] = 0.0
    return most


@njit
def _load_samples(b: np.ndarray, wanted: np.ndarray, loaded: np.ndarray, values: np.ndarray) -> None:
    """Bring the samples of inputs from outside into the table that a step needs and the last one did not."""
    for lane in range(_L):
        for end in range(2):
            if wanted[end, lane] != loaded[end, lane]:
                loaded[end, lane] = wanted[end, lane]
                put_sample(b, SAMPLE if end == 0 else SAMPLE_NEXT, lane, values, wanted[end, lane])


@njit(cache=True)
def _write(
    joints: np.ndarray,
    laws: np.ndarray | None,
    row: int,
    rows: np.ndarray,
    times: np.ndarray,
    machines: np.ndarray,
    command_values: np.ndarray,
    held: np.ndarray,
    pull_time: np.ndarray,
    measured: np.ndarray,
    probe_spacing: np.ndarray,
    probe_places: np.ndarray,
    probe_values: np.ndarray,
    b: np.ndarray,
    out: np.ndarray,
    done: np.ndarray,
) -> None:
    """Write a row of every machine that has not ended, and pull them to what was measured."""
    for lane in range(_L):
        joint, last = joints[lane], rows[lane] - 1
        s, d, play = state_in(b, STATE, lane), drive_in(b, STATE, lane), b[(STATE + 14) * _L + lane]
        if row > last or done[lane] <= last:
            continue
        if out_of_bounds(d.x, s):
            done[lane] = row
            continue
        t = times[lane, row]
        time = t - machines[lane, 0]
        volts = arrived(command_values[lane], held[lane], joint)
        inertia = inertia_at(time, b[ROD * _L + lane], joint)
        law = None if laws is None else laws[lane]
        near = near_in(b, NEAR, lane)
        first, many = probe_places[lane]
        probe = probe_at(t, times[lane, 0], probe_spacing[lane], probe_values[first : first + many])
        written(d, s, play, volts, time, inertia, probe, law, near, None, joint, out[lane, row])
        if pull_time[lane] > 0.0 and row < last:
            share = 1.0 - math.exp((t - times[lane, row + 1]) / pull_time[lane])
            s, by = pulled(s, share, out[lane, row, 0], measured[lane, row])
            put(b, STATE, lane, s, d, play + by)


@njit(cache=True)
def _leave(
    joints: np.ndarray,
    times: np.ndarray,
    rows: np.ndarray,
    machines: np.ndarray,
    b: np.ndarray,
    states: np.ndarray,
) -> None:
    """The machines' final states."""
    for lane in range(_L):
        joint = joints[lane]
        s, d, v = state_in(b, STATE, lane), drive_in(b, STATE, lane), states[lane]
        playing, rocking = hooks.linkage_gap(joint) > 0.0, hooks.base_stiffness(joint) > 0.0
        v[0], v[1], v[2], v[3], v[4], v[5], v[6] = d.x, d.xd, s.p_a, s.p_b, s.q, s.w, s.supply
        v[7], v[8] = (s.tilt, s.tilt_rate) if rocking else (0.0, 0.0)
        v[9], v[10] = (s.lead_q, s.lead_w) if playing else (s.q, s.w)
        v[11], v[12] = b[(STATE + 14) * _L + lane], times[lane, rows[lane] - 1] - machines[lane, 0]
        v[13], v[14], v[15], v[16] = d.behind, d.currents.a, d.currents.b, s.relief
