"""Joints that move together, integrated in one compiled loop.

Each joint's chain is that of `kernel`, with the same stages of the integrator. What couples joints is added between
them: one supply feeds all, and the links of an arm turn on each other (`physics.serial_arm`). A joint's own rates are
those with the other joints held; from its acceleration there follows the moment that is left for motion, and from all
moments the accelerations of the arm. Stiff friction enters a step through the diagonal D of its slopes, with the whole
mass matrix M: (M + GAMMA h D)^-1 M where a joint alone has 1 / (1 + GAMMA h d / I).
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit

from hydrolek_drake.physics import command, hooks, load, sensor, supply
from hydrolek_drake.physics.amplifier import Currents
from hydrolek_drake.physics.angle import Angle, angle_near
from hydrolek_drake.physics.probes import SUPPLY, Probe, added, no_probe
from hydrolek_drake.physics.serial_arm import accelerations, motion_equation
from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.rollout.kernel import (
    SIGNALS,
    Drive,
    acts_early,
    arrived,
    driven_on,
    first_stage,
    inertia_at,
    out_of_bounds,
    second_stage,
    written,
)
from hydrolek_drake.rollout.rates import Slopes, State, Turned, felt_at, rates, turned

TOLD = (*SIGNALS, "drawn")
"""What is written of each joint; `drawn`: the flow from the supply [m^3/s]."""


class Room(NamedTuple):
    """Rows for what each joint has between two stages of a step."""

    rates: np.ndarray  # `State` at the beginning. # (n, 9)
    middle: np.ndarray  # `State` after the first stage. # (n, 9)
    later: np.ndarray  # rates there. # (n, 9)
    slopes: np.ndarray  # `Slopes` at the beginning. # (n, 5)
    near: np.ndarray  # `Turned` at the last row. # (n, 6)
    volts: np.ndarray  # voltage that drives meanwhile. # (n,)
    spool: np.ndarray  # its position before the step. # (n,)
    inertia: np.ndarray  # of each joint with the others held. # (n,)
    rod: np.ndarray  # part of it that is the rod's. # (n,)
    drag: np.ndarray  # D. # (n,)
    drawn: np.ndarray  # from the supply. # (n,)
    torque: np.ndarray  # (n,)
    bias: np.ndarray  # (n,)
    payload: np.ndarray  # (n,)
    mass: np.ndarray  # M at the beginning. # (n, n)
    factor: np.ndarray  # of a matrix. # (n, n)


def room(n: int) -> Room:
    """Room for so many joints."""
    wide = [np.zeros((n, width)) for width in (len(State._fields),) * 3 + (len(Slopes._fields), 6)]
    return Room(*wide, *np.zeros((9, n)), *np.zeros((2, n, n)))


@njit
def _state(rows: np.ndarray, i: int) -> State:
    r = rows
    return State(r[i, 0], r[i, 1], r[i, 2], r[i, 3], r[i, 4], r[i, 5], r[i, 6], r[i, 7], r[i, 8])


@njit
def _keep(rows: np.ndarray, i: int, s: State) -> None:
    rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4] = s.p_a, s.p_b, s.q, s.w, s.flow
    rows[i, 5], rows[i, 6], rows[i, 7], rows[i, 8] = s.tilt, s.tilt_rate, s.lead_q, s.lead_w


@njit
def _near(rows: np.ndarray, i: int) -> Turned:
    r = rows
    return Turned(Angle(r[i, 0], r[i, 1], r[i, 2]), Angle(r[i, 3], r[i, 4], r[i, 5]))


@njit
def _own(laws: np.ndarray | None, first: np.ndarray, i: int) -> np.ndarray | None:
    """Rows of a joint's law; none for any is known when this is compiled, as in `law.felt`."""
    if laws is None:
        return None
    return laws[first[i] : first[i + 1]]


@njit
def _slopes(rows: np.ndarray, i: int) -> Slopes:
    return Slopes(rows[i, 0], rows[i, 1], rows[i, 2], rows[i, 3], rows[i, 4])


@njit
def _drive(rows: np.ndarray, i: int) -> Drive:
    return Drive(rows[i, 0], Currents(rows[i, 1], rows[i, 2]), rows[i, 3], rows[i, 4])


@njit
def _shared(
    time: float,
    states: np.ndarray,
    spool: np.ndarray,
    laws: np.ndarray | None,
    first: np.ndarray,
    joints: np.ndarray,
) -> float:
    """What laws of all joints add to the supply pressure [Pa]."""
    total = 0.0
    if laws is not None:
        for i in range(len(joints)):
            own = _own(laws, first, i)
            total += felt_at(no_probe(), own, time, _state(states, i), spool[i], joints[i]).supply
    return total


@njit
def _from_others(
    i: int,
    shared: float,
    time: float,
    states: np.ndarray,
    spool: np.ndarray,
    laws: np.ndarray | None,
    first: np.ndarray,
    joints: np.ndarray,
) -> Probe:
    """What a joint feels of the other joints' laws: their part of the supply pressure."""
    if laws is None or shared == 0.0:
        return no_probe()
    own = felt_at(no_probe(), _own(laws, first, i), time, _state(states, i), spool[i], joints[i])
    return added(no_probe(), SUPPLY, shared - own.supply)


@njit
def _all_rates(
    states: np.ndarray,
    spool: np.ndarray,
    time: float,
    laws: np.ndarray | None,
    first: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    r: Room,
    later: bool,
    carriers: np.ndarray,
    joints: np.ndarray,
) -> None:
    """Rates of all joints into `r.rates` with their slopes, or into `r.later`; M into `r.mass` or `r.factor`.

    The accelerations of linked joints are those of the whole arm. At the beginning of a step `r.drag` is told.
    """
    n = len(joints)
    shared = _shared(time, states, spool, laws, first, joints)
    total = 0.0
    into = r.later if later else r.rates
    for i in range(n):
        joint = joints[i]
        s = _state(states, i)
        outside = _from_others(i, shared, time, states, spool, laws, first, joints)
        own = _own(laws, first, i)
        near = _near(r.near, i)
        k, slope, _, _, drawn = rates(s, spool[i], r.volts[i], time, r.inertia[i], outside, own, near, joint)
        _keep(into, i, k)
        total += drawn
        if not later:
            r.slopes[i, 0], r.slopes[i, 1], r.slopes[i, 2] = slope.p_a, slope.p_b, slope.w
            r.slopes[i, 3], r.slopes[i, 4] = slope.tilt_rate, slope.lead_w
        carried = load.gravity_load_at(angle_near(s.q, near.position), time, joint)
        r.torque[i] = k.w * r.inertia[i] + carried
        r.payload[i] = hooks.payload(time, carriers[i])
    for i in range(n):
        into[i, 4] = supply.flow_rate_of_change(states[i, 4], total, joints[i])
    if len(links) == 0:
        return
    matrix = r.factor if later else r.mass
    motion_equation(links, states[:, 2], states[:, 3], r.payload, scratch, matrix, r.bias)
    for i in range(n):
        matrix[i, i] += r.rod[i]
        r.torque[i] -= r.bias[i]


@njit
def _lessened(r: Room, h: float) -> None:
    """Solve (M + GAMMA h D) a = torque into `r.torque`."""
    r.factor[:] = r.mass
    for i in range(len(r.torque)):
        r.factor[i, i] += GAMMA * h * r.drag[i]
    accelerations(r.factor, r.torque)


@njit
def _arm_begins(r: Room, h: float) -> None:
    """Give the accelerations at the beginning, lessened by stiff friction, to `r.rates`."""
    for i in range(len(r.torque)):
        r.drag[i] = -r.slopes[i, 2] * r.inertia[i]
        r.slopes[i, 2] = 0.0
    _lessened(r, h)
    r.rates[:, 3] = r.torque


@njit
def _arm_goes_on(r: Room, h: float) -> None:
    """Give `r.later` accelerations with which `second_stage` without a slope lessens them, see the module."""
    accelerations(r.factor, r.torque)
    change = r.torque - 2.0 * r.rates[:, 3]
    for i in range(len(change)):
        total = 0.0
        for k in range(len(change)):
            total += r.mass[i, k] * change[k]
        r.torque[i] = total
    _lessened(r, h)
    for i in range(len(change)):
        r.later[i, 3] = r.torque[i] + 2.0 * r.rates[i, 3]


@njit
def _step(
    states: np.ndarray,
    drives: np.ndarray,
    commands: np.ndarray,
    time: float,
    h: float,
    spool_steps: int,
    laws: np.ndarray | None,
    first: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    r: Room,
    carriers: np.ndarray,
    joints: np.ndarray,
) -> None:
    """One step of `h` seconds of all joints; rows of `drives` are those of `Drive`."""
    n = len(joints)
    shared = _shared(time, states, drives[:, 3], laws, first, joints)
    for i in range(n):
        joint = joints[i]
        own = _own(laws, first, i)
        outside = _from_others(i, shared, time, states, drives[:, 3], laws, first, joints)
        d = _drive(drives, i)
        voltage = command.drive_voltage(commands[i], joint)
        early = acts_early(own, joint)
        s = _state(states, i)
        r.spool[i] = d.x
        d, r.volts[i] = driven_on(
            d, s, commands[i], voltage, time, h, spool_steps, early, outside, outside, own, joint
        )
        drives[i, 0], drives[i, 1], drives[i, 2] = d.behind, d.currents.a, d.currents.b
        drives[i, 3], drives[i, 4] = d.x, d.xd
        r.inertia[i] = inertia_at(time, r.rod[i], joint)
    linked = len(links) > 0
    _all_rates(states, r.spool, time, laws, first, links, scratch, r, False, carriers, joints)
    if linked:
        _arm_begins(r, h)
    for i in range(n):
        _keep(r.middle, i, first_stage(_state(states, i), _state(r.rates, i), _slopes(r.slopes, i), h))
    _all_rates(r.middle, drives[:, 3], time + h, laws, first, links, scratch, r, True, carriers, joints)
    if linked:
        _arm_goes_on(r, h)
    for i in range(n):
        s = second_stage(_state(states, i), _state(r.rates, i), _state(r.later, i), _slopes(r.slopes, i), h)
        _keep(states, i, s)


@njit(cache=True, nogil=True)
def integrate_together(
    joints: np.ndarray,
    carriers: np.ndarray,
    states: np.ndarray,
    drives: np.ndarray,
    plays: np.ndarray,
    command_times: np.ndarray,
    command_values: np.ndarray,
    times: np.ndarray,
    longest_step: float,
    spool_steps: int,
    laws: np.ndarray | None,
    first: np.ndarray,
    links: np.ndarray,
    scratch: np.ndarray,
    r: Room,
    out: np.ndarray,
) -> int:
    """Integrate joints through their commands and write their signals at `times`.

    Args:
        joints: parameter records, shape (n,).
        carriers: records that say what hangs on each link, shape (n,).
        states: rows of `State`; all have the flow of the supply, shape (n, 9).
        drives: rows of `Drive`, shape (n, 5).
        plays: what the sensors' plays read, shape (n,).
        command_times: when commands change [s], shape (m,).
        command_values: held from then on [V], shape (m, n); neutral before the first one has arrived.
        times: when to write [s], shape (k,); the integration starts at the first, when the machine is switched on.
        longest_step: [s].
        spool_steps: spool steps within one step.
        laws: rows of `law.LAW` of all joints, joint after joint, or None.
        first: which of them is a joint's first one, and their number at the end, shape (n + 1,).
        links: of the arms that the joints turn, in their order, or without rows.
        scratch: room for as many.
        r: room for as many joints.
        out: `TOLD`, shape (k, n, 9).

    Returns:
        Number of rows written; less than k if the simulation diverged at that row.
    """
    n = len(joints)
    last = len(command_times) - 1
    held = np.full(n, -1)
    delays = np.empty(n)
    acting = np.empty(n)
    for i in range(n):
        r.rod[i] = load.reflected_rod_inertia(joints[i])
        delays[i] = command.transport_delay(joints[i])
        acting[i] = arrived(command_values[:, i], -1, joints[i])
    on = times[0]
    t = on
    for row in range(len(times)):
        target = times[row]
        for i in range(n):
            near = turned(_state(states, i), joints[i])
            p, c = near.position, near.included
            values = r.near[i]
            values[0], values[1], values[2], values[3], values[4], values[5] = (
                p.value, p.sine, p.cosine, c.value, c.sine, c.cosine,
            )  # fmt: skip
        while t < target:
            until = target
            for i in range(n):
                values = command_values[:, i]
                while held[i] < last and command_times[held[i] + 1] + delays[i] <= t + 1e-12:
                    held[i] += 1
                acting[i] = arrived(values, held[i], joints[i])
                following = held[i] + 1
                while held[i] >= 0 and following <= last and values[following] == values[held[i]]:
                    following += 1
                if following <= last and command_times[following] + delays[i] < until:
                    until = max(command_times[following] + delays[i], t)
            steps = max(math.ceil((until - t) / longest_step - 1e-9), 1)
            h = (until - t) / steps
            if h > 0.0:
                for step in range(steps):
                    _step(
                        states,
                        drives,
                        acting,
                        t + step * h - on,
                        h,
                        spool_steps,
                        laws,
                        first,
                        links,
                        scratch,
                        r,
                        carriers,
                        joints,
                    )
                    for i in range(n):
                        plays[i] = sensor.played(plays[i], states[i, 2] - states[i, 5], joints[i])
            t = until
        now = t - on
        shared = _shared(now, states, drives[:, 3], laws, first, joints)
        for i in range(n):
            joint, s, own = joints[i], _state(states, i), _own(laws, first, i)
            if out_of_bounds(drives[i, 3], s):
                return row
            drive = _drive(drives, i)
            outside = _from_others(i, shared, now, states, drives[:, 3], laws, first, joints)
            inertia = inertia_at(now, r.rod[i], joint)
            acts = arrived(command_values[:, i], held[i], joint)
            told = out[row, i]
            told[8] = written(
                drive, s, plays[i], acts, now, inertia, outside, own, _near(r.near, i), joint, told
            )
    return len(times)
