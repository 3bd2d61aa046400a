"""Machines in lanes: the chain of `rollout.kernel`, stepped in lockstep, with the lanes as the innermost loop.

Each machine has its own command, moments at which it arrives, and times at which signals are wanted, and so its own
steps between two rows of signals; a lane that needs fewer than another, or has ended, stands still for the rest. No
lane reads what another one writes.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, sensor
from hydrolek_drake.physics.probes import no_probe
from hydrolek_drake.rollout.drive import driven_on
from hydrolek_drake.rollout.kernel import (
    inertia_at,
)
from hydrolek_drake.rollout.lanes.rows import enter, leave, load_samples, plan, write
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
    state_in,
)
from hydrolek_drake.rollout.lanes.view import (
    LANES,
    early_of,
    lane_joint,
    lane_law,
    probed_of,
    spool_steps_of,
)
from hydrolek_drake.rollout.rates import carried_on
from hydrolek_drake.rollout.rosenbrock import one_step

_L = LANES


@njit(forceinline=False)  # it is optimised once, and not again with all that calls it
def _all_lanes(kind: Any, b: np.ndarray) -> None:
    """One step of every machine, from the rows of `STATE` to those of `NEXT`."""
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
        b[f + 16 * _L] = n.bent if go else s.bent
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
        states: see `rollout.kernel.integrate`, shape (lanes, 18); hold the final states afterwards.
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
    b = enter(joints, numbers, laws, states, times, machines)
    done[:] = rows
    for row in range(rows.max()):
        most = plan(
            joints, row, rows, times, machines, command_times, command_values, longest_step, b,
            held, steps, probe_spacing, probe_places, probe_values, samples,
        )  # fmt: skip
        for i in range(most):
            b[H * _L : (H + told) * _L] = steps[i, :told].ravel()
            if probed_of(kind):
                load_samples(b, samples[i], loaded, probe_values)
            _all_lanes(kind, b)
            b[STATE * _L : (STATE + KEPT) * _L] = b[NEXT * _L : (NEXT + KEPT) * _L]
            b[NEAR * _L : (NEAR + 6) * _L] = b[NEAR_NEXT * _L : (NEAR_NEXT + 6) * _L]
        write(
            joints, laws, row, rows, times, machines, command_values, held, pull_time, measured,
            probe_spacing, probe_places, probe_values, b, out, done,
        )  # fmt: skip
    leave(joints, times, rows, machines, b, states)
