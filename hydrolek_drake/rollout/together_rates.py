"""What couples joints that move together: one supply, laws that act on it, and the arms' equation of motion.

A joint's own rates are those with the other joints held; from its acceleration there follows the moment that is left
for motion, and from all moments the accelerations of the arm. Stiff friction enters a step through the diagonal D of
its slopes, with the whole mass matrix M: (M + GAMMA h D)^-1 M where a joint alone has 1 / (1 + GAMMA h d / I).
"""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks, load, supply
from hydrolek_drake.physics.angle import angle_near
from hydrolek_drake.physics.probes import SUPPLY, Probe, added, no_probe
from hydrolek_drake.physics.serial_arm import accelerations, motion_equation
from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.rollout.joint_rows import (
    ANGLE,
    BIAS,
    DRAG,
    FACTOR,
    INERTIA,
    LATER,
    MASS,
    OF_SUPPLY,
    PAYLOAD,
    RATES,
    ROD,
    SLOPES,
    SPEED,
    STIFF_SUPPLY,
    STIFF_W,
    TORQUE,
    VOLTS,
    W,
    near_at,
    put_state,
    state_at,
)
from hydrolek_drake.rollout.rates import felt_at, rates


@njit
def own_law(laws: np.ndarray | None, first: np.ndarray, i: int) -> np.ndarray | None:
    """Rows of a joint's law; none for any is known when this is compiled, as in `law.felt`."""
    if laws is None:
        return None
    return laws[first[i] : first[i + 1]]


@njit
def shared_supply(
    r: np.ndarray,
    at: int,
    spool: int,
    time: float,
    laws: np.ndarray | None,
    first: np.ndarray,
    joints: np.ndarray,
) -> float:
    """What laws of all joints add to the supply pressure [Pa], in the states that begin at a place of their rows."""
    total = 0.0
    if laws is not None:
        for i in range(len(joints)):
            own = own_law(laws, first, i)
            total += felt_at(no_probe(), own, time, state_at(r, i, at), r[i, spool], joints[i]).supply
    return total


@njit
def from_others(
    r: np.ndarray,
    i: int,
    at: int,
    spool: int,
    shared: float,
    time: float,
    laws: np.ndarray | None,
    first: np.ndarray,
    joints: np.ndarray,
) -> Probe:
    """What a joint feels of the other joints' laws: their part of the supply pressure."""
    if laws is None or shared == 0.0:
        return no_probe()
    own = felt_at(no_probe(), own_law(laws, first, i), time, state_at(r, i, at), r[i, spool], joints[i])
    return added(no_probe(), SUPPLY, shared - own.supply)


@njit
def all_rates(
    r: np.ndarray,
    at: int,
    spool: int,
    into: int,
    time: float,
    laws: np.ndarray | None,
    first: np.ndarray,
    vectors: np.ndarray,
    carriers: np.ndarray,
    joints: np.ndarray,
) -> None:
    """Rates of all joints with the other ones held, and the moments that are left for motion.

    Args:
        r: rows of `room`.
        at: where the states begin in them.
        spool: where the spools' positions stand.
        into: where the rates begin; at the beginning of a step slopes are told too.
        time: since switching on [s].
        laws: as of `integrate_together`, and so `first`, `carriers` and `joints`.
        first: see there.
        vectors: those of `room`.
        carriers: see there.
        joints: see there.
    """
    n = len(joints)
    shared = shared_supply(r, at, spool, time, laws, first, joints)
    total = 0.0
    for i in range(n):
        joint = joints[i]
        s = state_at(r, i, at)
        outside = from_others(r, i, at, spool, shared, time, laws, first, joints)
        near = near_at(r, i)
        k, slope, _, _, drawn = rates(
            s, r[i, spool], r[i, VOLTS], time, r[i, INERTIA], outside, own_law(laws, first, i), near, joint
        )
        put_state(r, i, into, k)
        total += drawn
        if into == RATES:
            f = SLOPES
            r[i, f], r[i, f + 1], r[i, f + 2], r[i, f + 3] = slope.p_a, slope.p_b, slope.w, slope.tilt_rate
            r[i, f + 4] = slope.lead_w
        carried = load.gravity_load_at(angle_near(s.q, near.position), time, joint)
        vectors[TORQUE, i] = k.w * r[i, INERTIA] + carried
        vectors[PAYLOAD, i] = hooks.payload(time, carriers[i])
        vectors[ANGLE, i], vectors[SPEED, i] = s.q, s.w
    for i in range(n):
        r[i, into + OF_SUPPLY], slope_supply = supply.rate_of_change(r[i, at + OF_SUPPLY], total, joints[i])
        if into == RATES:
            r[i, SLOPES + STIFF_SUPPLY] = slope_supply


@njit
def arm_equation(
    r: np.ndarray, vectors: np.ndarray, matrix: np.ndarray, links: np.ndarray, scratch: np.ndarray
) -> None:
    """The arms' mass matrix with the rods, and their moments less what holds the speeds as they are."""
    motion_equation(links, vectors[ANGLE], vectors[SPEED], vectors[PAYLOAD], scratch, matrix, vectors[BIAS])
    for i in range(len(r)):
        matrix[i, i] += r[i, ROD]
        vectors[TORQUE, i] -= vectors[BIAS, i]


@njit
def _lessened(r: np.ndarray, torque: np.ndarray, matrices: np.ndarray, h: float) -> None:
    """Solve (M + GAMMA h D) a = torque in place."""
    for i in range(len(r)):
        for k in range(len(r)):
            matrices[FACTOR, i, k] = matrices[MASS, i, k]
        matrices[FACTOR, i, i] += GAMMA * h * r[i, DRAG]
    accelerations(matrices[FACTOR], torque)


@njit
def arm_begins(r: np.ndarray, torque: np.ndarray, matrices: np.ndarray, h: float) -> None:
    """Give the accelerations at the beginning, lessened by stiff friction, to the rates there."""
    for i in range(len(r)):
        r[i, DRAG] = -r[i, SLOPES + STIFF_W] * r[i, INERTIA]
        r[i, SLOPES + STIFF_W] = 0.0
    _lessened(r, torque, matrices, h)
    for i in range(len(r)):
        r[i, RATES + W] = torque[i]


@njit
def arm_goes_on(
    r: np.ndarray, torque: np.ndarray, change: np.ndarray, matrices: np.ndarray, h: float
) -> None:
    """Give the later rates accelerations with which `second_stage` without a slope lessens them, see the module."""
    accelerations(matrices[FACTOR], torque)
    for i in range(len(r)):
        change[i] = torque[i] - 2.0 * r[i, RATES + W]
    for i in range(len(r)):
        torque[i] = 0.0
        for k in range(len(r)):
            torque[i] += matrices[MASS, i, k] * change[k]
    _lessened(r, torque, matrices, h)
    for i in range(len(r)):
        r[i, LATER + W] = torque[i] + 2.0 * r[i, RATES + W]
