"""Joints that move together, integrated in one compiled loop.

Each joint's chain is that of `kernel`, with the same stages of the integrator; what couples joints stands in
`together_rates`.
"""

import math

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import command, load, sensor
from hydrolek_drake.physics.solenoid import steps_needed
from hydrolek_drake.rollout.drive import acts_early, driven_on
from hydrolek_drake.rollout.joint_rows import (
    BIAS,
    COMMAND,
    DRIVE,
    FACTOR,
    INERTIA,
    LATER,
    MASS,
    MIDDLE,
    NEAR,
    PLAY,
    RATES,
    ROD,
    SPOOL,
    STATE,
    TORQUE,
    VOLTS,
    X,
    drive_at,
    near_at,
    put_state,
    slopes_at,
    state_at,
)
from hydrolek_drake.rollout.kernel import (
    SIGNALS,
    arrived,
    first_stage,
    inertia_at,
    out_of_bounds,
    second_stage,
    written,
)
from hydrolek_drake.rollout.rates import turned
from hydrolek_drake.rollout.together_rates import (
    all_rates,
    arm_begins,
    arm_equation,
    arm_goes_on,
    from_others,
    own_law,
    shared_supply,
)

TOLD = (*SIGNALS, "drawn")
"""What is written of each joint; `drawn`: the flow from the supply [m^3/s]."""


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
) -> None:
    """One step of `h` seconds of all joints."""
    n = len(joints)
    shared = shared_supply(r, STATE, DRIVE + X, time, laws, first, joints)
    for i in range(n):
        joint = joints[i]
        own = own_law(laws, first, i)
        outside = from_others(r, i, STATE, DRIVE + X, shared, time, laws, first, joints)
        d = drive_at(r, i)
        volts = r[i, COMMAND]
        voltage = command.drive_voltage(volts, joint)
        s = state_at(r, i, STATE)
        r[i, SPOOL] = d.x
        steps = steps_needed(spool_steps, joint)
        d, r[i, VOLTS] = driven_on(
            d, s, volts, voltage, time, h, steps, acts_early(own, joint), outside, outside, own, joint
        )
        f = DRIVE
        r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3] = d.behind, d.currents.a, d.currents.b, d.x
        r[i, f + 4] = d.xd
        r[i, INERTIA] = inertia_at(time, r[i, ROD], joint)
    linked = len(links) > 0
    all_rates(r, STATE, SPOOL, RATES, time, laws, first, vectors, carriers, joints)
    if linked:
        arm_equation(r, vectors, matrices[MASS], links, scratch)
        arm_begins(r, vectors[TORQUE], matrices, h)
    for i in range(n):
        put_state(
            r,
            i,
            MIDDLE,
            first_stage(state_at(r, i, STATE), state_at(r, i, RATES), slopes_at(r, i), h, joints[i]),
        )
    all_rates(r, MIDDLE, DRIVE + X, LATER, time + h, laws, first, vectors, carriers, joints)
    if linked:
        arm_equation(r, vectors, matrices[FACTOR], links, scratch)
        arm_goes_on(r, vectors[TORQUE], vectors[BIAS], matrices, h)
    for i in range(n):
        begun, rate, later = state_at(r, i, STATE), state_at(r, i, RATES), state_at(r, i, LATER)
        s = second_stage(begun, rate, later, slopes_at(r, i), h, joints[i])
        put_state(r, i, STATE, s)
        r[i, PLAY] = sensor.played(r[i, PLAY], s.q - s.tilt, joints[i])


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
    out: np.ndarray,
) -> int:
    """Integrate joints through their commands and write their signals at `times`.

    Args:
        joints: parameter records, shape (n,).
        carriers: records that say what hangs on each link, shape (n,).
        r: rows of `room`, with `STATE`, all of which have the flow of the supply, `DRIVE` and `PLAY` at the beginning.
        vectors: those of `room`.
        matrices: those of `room`.
        command_times: when commands change [s], shape (m,).
        command_values: held from then on [V], shape (m, n); neutral before the first one has arrived.
        times: when to write [s], shape (k,); the integration starts at the first, when the machine is switched on.
        longest_step: [s].
        spool_steps: spool steps within one step.
        laws: rows of `law.LAW` of all joints, joint after joint, or None.
        first: which of them is a joint's first one, and their number at the end, shape (n + 1,).
        links: of the arms that the joints turn, in their order, or without rows.
        scratch: of `serial_arm`, for as many.
        out: `TOLD`, shape (k, n, 9).

    Returns:
        Number of rows written; less than k if the simulation diverged at that row.
    """
    n = len(joints)
    last = len(command_times) - 1
    held = np.full(n, -1)
    delays = np.empty(n)
    for i in range(n):
        r[i, ROD] = load.reflected_rod_inertia(joints[i])
        delays[i] = command.transport_delay(joints[i])
    on = times[0]
    t = on
    for row in range(len(times)):
        target = times[row]
        for i in range(n):
            near = turned(state_at(r, i, STATE), joints[i])
            f = NEAR
            r[i, f], r[i, f + 1], r[i, f + 2] = near.position
            r[i, f + 3], r[i, f + 4], r[i, f + 5] = near.included
        while t < target:
            until = target
            for i in range(n):
                while held[i] < last and command_times[held[i] + 1] + delays[i] <= t + 1e-12:
                    held[i] += 1
                r[i, COMMAND] = arrived(command_values[:, i], held[i], joints[i])
                following = held[i] + 1
                while (
                    held[i] >= 0
                    and following <= last
                    and command_values[following, i] == command_values[held[i], i]
                ):
                    following += 1
                if following <= last and command_times[following] + delays[i] < until:
                    until = max(command_times[following] + delays[i], t)
            steps = max(math.ceil((until - t) / longest_step - 1e-9), 1)
            h = (until - t) / steps
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
                    )
            t = until
        now = t - on
        shared = shared_supply(r, STATE, DRIVE + X, now, laws, first, joints)
        for i in range(n):
            joint, s, d = joints[i], state_at(r, i, STATE), drive_at(r, i)
            if out_of_bounds(d.x, s):
                return row
            outside = from_others(r, i, STATE, DRIVE + X, shared, now, laws, first, joints)
            inertia = inertia_at(now, r[i, ROD], joint)
            volts = arrived(command_values[:, i], held[i], joint)
            told = out[row, i]
            told[8] = written(
                d,
                s,
                r[i, PLAY],
                volts,
                now,
                inertia,
                outside,
                own_law(laws, first, i),
                near_at(r, i),
                joint,
                told,
            )
    return len(times)
