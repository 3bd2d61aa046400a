"""Joints that move together, integrated in one compiled loop.

Each joint's chain is that of `rollout.kernel`, with the same stages of the integrator; what couples joints stands in
`rates`.
"""

import math

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, hooks, load
from hydrolek_drake.physics.bodies.serial_arm import CARRIES
from hydrolek_drake.physics.driven import driven_by
from hydrolek_drake.physics.probes import probe_at
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.rollout.drive import acts_early
from hydrolek_drake.rollout.kernel import SIGNALS, inertia_at, out_of_bounds, written
from hydrolek_drake.rollout.rates import kept, turned
from hydrolek_drake.rollout.stretches import arrived
from hydrolek_drake.rollout.together.joint import begins, ends, goes_on, halfway
from hydrolek_drake.rollout.together.joint_rows import (
    BIAS,
    COMMAND,
    DRIVE,
    MASS,
    MIDDLE,
    PAYLOAD,
    PLAY,
    ROD,
    STATE,
    THERE,
    TORQUE,
    X,
    drive_at,
    near_at,
    put_near,
    state_at,
)
from hydrolek_drake.rollout.together.rates import (
    arm_begins,
    arm_equation,
    arm_goes_on,
    drawn_by_all,
    from_others,
    own_law,
    shared_supply,
)

TOLD = (*SIGNALS, "drawn")
"""What is written of each joint; `drawn`: the flow from the supply [m^3/s]."""

DRAWN_TOLD = len(SIGNALS)
"""Its place."""


@njit
def _step(
    r: np.ndarray,
    time: float,
    h: float,
    spool_steps: int,
    laws: np.ndarray | None,
    first: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    vectors: np.ndarray,
    matrices: np.ndarray,
    carriers: np.ndarray,
    joints: np.ndarray,
    spacing: float,
    recorded: np.ndarray | None,
) -> None:
    """One step of `h` seconds of all joints."""
    n = len(joints)
    shared = shared_supply(r, STATE, DRIVE + X, time, laws, first, joints)
    for i in range(n):
        joint = joints[i]
        own = own_law(laws, first, i)
        outside = from_others(r, i, STATE, DRIVE + X, shared, time, laws, first, joints)
        if recorded is not None:
            outside = driven_by(probe_at(time, 0.0, spacing, recorded[i]), outside)
        steps = steps_needed(spool_steps, joint)
        begins(r, i, time, h, steps, acts_early(own, joint), outside, own, joint)
    drawn_by_all(r)
    if len(links) > 0:
        put_payloads(vectors[PAYLOAD], links, carriers, time)
        arm_equation(r, STATE, vectors, matrices[MASS], links, scratch)
        arm_begins(r, vectors[TORQUE], matrices, links, h)
    for i in range(n):
        halfway(r, i, h, joints[i])
    shared = shared_supply(r, MIDDLE, DRIVE + X, time + h, laws, first, joints)
    for i in range(n):
        own = own_law(laws, first, i)
        outside = from_others(r, i, MIDDLE, DRIVE + X, shared, time + h, laws, first, joints)
        if recorded is not None:
            outside = driven_by(probe_at(time + h, 0.0, spacing, recorded[i]), outside)
        goes_on(r, i, r[i, DRIVE + X], time + h, h, outside, own, joints[i])
    drawn_by_all(r)
    if len(links) > 0:
        put_payloads(vectors[PAYLOAD], links, carriers, time + h)
        arm_equation(r, MIDDLE, vectors, matrices[THERE], links, scratch)
        arm_goes_on(r, vectors[TORQUE], vectors[BIAS], matrices, links)
    for i in range(n):
        ends(r, i, h, joints[i])


@njit
def put_payloads(payload: np.ndarray, links: np.ndarray, carriers: np.ndarray, time: float) -> None:
    """Write what hangs on each link that carries something [kg], at a time since switching on [s]."""
    for i in range(len(links)):
        if links[i, CARRIES] > 0.0:
            payload[i] = hooks.payload(time, carriers[i])


@njit
def next_stretch_of_all(
    t: float,
    target: float,
    held: np.ndarray,
    delays: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    longest_step: float,
) -> tuple[float, int, float]:
    """As of `rollout.kernel.next_stretch`, with the commands of all joints the same: its end, steps and their length.

    Args:
        t: [s].
        target: [s].
        held: place of the command of each joint that has acted, -1 for none; moved on. # (n,)
        delays: of their commands [s]. # (n,)
        command_times: [s]. # (m,)
        command_values: [V]. # (m, n)
        longest_step: [s].
    """
    last = len(command_times) - 1
    until = target
    for i in range(len(held)):
        while held[i] < last and command_times[held[i] + 1] + delays[i] <= t + 1e-12:
            held[i] += 1
        following = held[i] + 1
        while (
            held[i] >= 0 and following <= last and command_values[following, i] == command_values[held[i], i]
        ):
            following += 1
        if following <= last and command_times[following] + delays[i] < until:
            until = max(command_times[following] + delays[i], t)
    steps = max(math.ceil((until - t) / longest_step - 1e-9), 1)
    return until, steps, (until - t) / steps


@njit(cache=True, nogil=True)
def integrate_together(
    joints: np.ndarray,
    carriers: np.ndarray,
    r: np.ndarray,
    vectors: np.ndarray,
    matrices: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    longest_step: float,
    spool_steps: int,
    laws: np.ndarray | None,
    first: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    spacing: float,
    recorded: np.ndarray | None,
    since: float,
    out: np.ndarray,
) -> int:
    """Integrate joints through their commands and write their signals at `times`.

    Args:
        joints: parameter records, shape (n,).
        carriers: records that say what hangs on each link, shape (n,).
        r: rows of `room`, with `STATE`, all of which have what the supply remembers, `DRIVE` and `PLAY` at the
            beginning.
        vectors: those of `room`.
        matrices: those of `room`.
        command_times: when commands change [s], shape (m,).
        command_values: held from then on [V], shape (m, n); neutral before the first one has arrived.
        times: when to write [s], shape (k,); the integration starts at the first.
        longest_step: [s].
        spool_steps: spool steps within one step.
        laws: rows of `law.LAW` of all joints, joint after joint, or None.
        first: which of them is a joint's first one, and their number at the end, shape (n + 1,).
        links: of the arms that the joints turn, in their order, or without rows.
        scratch: of `serial_arm`, for as many.
        spacing: of the samples of what was recorded, from switching on [s].
        recorded: what drives joints in place of a part of them, `PROBES` at the places of `driven.INPUTS`, shape
            (n, samples, 15); None for nothing.
        since: time since switching on at the first of `times` [s].
        out: `TOLD`, shape (k, n, 9).

    Returns:
        Number of rows written; less than k if the simulation diverged at that row.
    """
    n = len(joints)
    held = np.full(n, -1)
    delays = np.empty(n)
    for i in range(n):
        r[i, ROD] = load.reflected_rod_inertia(joints[i])
        delays[i] = command.transport_delay(joints[i])
    t = times[0]
    on = t - since
    for row in range(len(times)):
        target = times[row]
        for i in range(n):
            put_near(r, i, kept(turned(state_at(r, i, STATE), joints[i])))
        while t < target:
            until, steps, h = next_stretch_of_all(
                t, target, held, delays, command_times, command_values, longest_step
            )
            for i in range(n):
                r[i, COMMAND] = arrived(command_values[:, i], held[i], joints[i])
            if h > 0.0:
                for step in range(steps):
                    time = t + step * h - on
                    _step(
                        r,
                        time,
                        h,
                        spool_steps,
                        laws,
                        first,
                        links,
                        scratch,
                        vectors,
                        matrices,
                        carriers,
                        joints,
                        spacing,
                        recorded,
                    )
            t = until
        now = t - on
        shared = shared_supply(r, STATE, DRIVE + X, now, laws, first, joints)
        for i in range(n):
            joint, s, d = joints[i], state_at(r, i, STATE), drive_at(r, i)
            if out_of_bounds(d.x, s):
                return row
            outside = from_others(r, i, STATE, DRIVE + X, shared, now, laws, first, joints)
            if recorded is not None:
                outside = driven_by(probe_at(now, 0.0, spacing, recorded[i]), outside)
            inertia = inertia_at(now, r[i, ROD], joint)
            volts = arrived(command_values[:, i], held[i], joint)
            told = out[row, i]
            told[DRAWN_TOLD] = written(
                d,
                s,
                r[i, PLAY],
                volts,
                now,
                inertia,
                outside,
                own_law(laws, first, i),
                near_at(r, i),
                None,
                joint,
                told,
            )
    return len(times)
