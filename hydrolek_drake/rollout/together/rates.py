"""What couples joints that move together: one supply, laws that act on it, and the arms' equation of motion.

A joint's own rates are those with the other joints held; from its acceleration there follows the moment that is left
for motion, and from all moments the accelerations of the arm. Stiff friction enters a step through the diagonal D of
its slopes, with the whole mass matrix M: (M + GAMMA h D)^-1 M where a joint alone has 1 / (1 + GAMMA h d / I); so does
the stiffness of the oil in the chambers (`rosenbrock.through_oil`).
"""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.bodies.mass_matrix import accelerations, factored, moments_of, solved
from hydrolek_drake.physics.bodies.serial_arm import motion_equation
from hydrolek_drake.physics.probes import SUPPLY, Probe, added, no_probe
from hydrolek_drake.physics.solenoid import GAMMA
from hydrolek_drake.rollout.rates import felt_at
from hydrolek_drake.rollout.together.joint_rows import (
    BIAS,
    COSINE,
    COSINES,
    DRAG,
    DRAWN,
    LATER,
    LESSENED,
    MASS,
    MOMENT,
    OIL,
    PAYLOAD,
    PUSH,
    RATES,
    ROD,
    SINE,
    SINES,
    SLOPES,
    SPEEDS,
    STIFF_W,
    THERE,
    TORQUE,
    TOTAL,
    TURNED_BY,
    W,
    state_at,
)


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
def drawn_by_all(r: np.ndarray) -> None:
    """Tell every joint what all of them draw from the supply."""
    total = r[0, DRAWN]
    for i in range(1, len(r)):
        total = total + r[i, DRAWN]
    for i in range(len(r)):
        r[i, TOTAL] = total


@njit
def arm_equation(
    r: np.ndarray, at: int, vectors: np.ndarray, matrix: np.ndarray, links: np.ndarray, scratch: np.ndarray
) -> None:
    """The arms' mass matrix with the rods, and their moments less what holds the speeds as they are.

    Args:
        r: rows of the joints, of one machine or of numbers of each lane.
        at: where the states begin in them.
        vectors: those of `room`, with the payloads.
        matrix: receives M.
        links: as of `integrate_together`.
        scratch: see there.
    """
    for i in range(len(links)):
        vectors[SINES, i], vectors[COSINES, i], vectors[SPEEDS, i] = r[i, SINE], r[i, COSINE], r[i, at + W]
    motion_equation(
        links,
        vectors[SINES],
        vectors[COSINES],
        vectors[SPEEDS],
        vectors[PAYLOAD],
        scratch,
        matrix,
        vectors[BIAS],
    )
    for i in range(len(links)):
        matrix[i, i] += r[i, ROD]
        vectors[TORQUE, i] = r[i, MOMENT] - vectors[BIAS, i]


@njit
def arm_begins(r: np.ndarray, torque: np.ndarray, matrices: np.ndarray, links: np.ndarray, h: float) -> None:
    """Give the accelerations at the beginning, lessened by stiff friction, to the rates there."""
    for i in range(len(links)):
        for k in range(i + 1):
            matrices[LESSENED, i, k] = matrices[MASS, i, k]
        r[i, SLOPES + STIFF_W] = r[i, SLOPES + TURNED_BY] = 0.0
        torque[i] += r[i, OIL] * r[i, PUSH]
        matrices[LESSENED, i, i] += GAMMA * h * r[i, DRAG]
    factored(links, matrices[LESSENED])
    solved(links, matrices[LESSENED], torque)
    for i in range(len(links)):
        r[i, RATES + W] = torque[i]


@njit
def arm_goes_on(
    r: np.ndarray, torque: np.ndarray, change: np.ndarray, matrices: np.ndarray, links: np.ndarray
) -> None:
    """Give the later rates accelerations with which `second_stage` without a slope lessens them, see the module."""
    accelerations(links, matrices[THERE], torque)
    for i in range(len(links)):
        change[i] = torque[i] - 2.0 * r[i, RATES + W]
    moments_of(links, matrices[MASS], change, torque)
    for i in range(len(links)):
        torque[i] += r[i, OIL] * r[i, PUSH]
    solved(links, matrices[LESSENED], torque)
    for i in range(len(links)):
        r[i, LATER + W] = torque[i] + 2.0 * r[i, RATES + W]
