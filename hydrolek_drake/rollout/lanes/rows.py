"""What is done between the steps of machines in lanes: entering, planning steps up to a row, writing it, leaving.

Other than the steps themselves it is done lane by lane, as in `rollout.kernel`.
"""

import math

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, hooks, load
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.probes import probe_at, sample_at
from hydrolek_drake.rollout.drive import Drive
from hydrolek_drake.rollout.kernel import (
    inertia_at,
    out_of_bounds,
    pulled,
    supply_pulled,
    written,
)
from hydrolek_drake.rollout.lanes.table import (
    NEAR,
    NUMBERS_OF_JOINT,
    ROD,
    SAMPLE,
    SAMPLE_NEXT,
    STATE,
    TERMS,
    drive_in,
    near_in,
    put,
    put_near,
    put_sample,
    state_in,
)
from hydrolek_drake.rollout.lanes.view import (
    LANES,
    NUMBERS,
)
from hydrolek_drake.rollout.rates import State, turned
from hydrolek_drake.rollout.stretches import arrived, next_stretch

_L = LANES


@njit(cache=True)
def enter(
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
        s = State(v[2], v[3], v[4], v[5], v[6], v[7], v[8], v[9], v[10], v[16], v[17])
        put(b, STATE, lane, s, Drive(v[13], Currents(v[14], v[15]), v[0], v[1]), v[11])
        b[ROD * _L + lane] = load.reflected_rod_inertia(joint)
        machines[lane, 0], machines[lane, 1] = times[lane, 0] - v[12], command.transport_delay(joint)
    return b


@njit(cache=True)
def plan(
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
def load_samples(b: np.ndarray, wanted: np.ndarray, loaded: np.ndarray, values: np.ndarray) -> None:
    """Bring the samples of inputs from outside into the table that a step needs and the last one did not."""
    for lane in range(_L):
        for end in range(2):
            if wanted[end, lane] != loaded[end, lane]:
                loaded[end, lane] = wanted[end, lane]
                put_sample(b, SAMPLE if end == 0 else SAMPLE_NEXT, lane, values, wanted[end, lane])


@njit(cache=True)
def write(
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
            s, by = pulled(s, share, out[lane, row, 0], measured[lane, row], joint)
            s = supply_pulled(s, share, probe, joint)
            put(b, STATE, lane, s, d, play + by)


@njit(cache=True)
def leave(
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
        v[17] = s.bent
