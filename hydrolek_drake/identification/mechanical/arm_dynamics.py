"""An arm with a gain, damping and springs at its joints, simulated thousands of times (thesis 4.5)."""

import numpy as np
from numba import njit

from hydrolek_drake.compiled import use_cache_for_this_source
from hydrolek_drake.physics.bodies.mass_matrix import accelerations
from hydrolek_drake.physics.bodies.serial_arm import motion_equation, scratch

use_cache_for_this_source()


def simulate_joints(
    command: np.ndarray, step: float, gain: float, damping: float, stiffness: float, links: np.ndarray
) -> np.ndarray:
    """Angles of all joints, M q'' + c + D q' + S q = K u, from rest at zero.

    The linearly implicit Euler method: damping and stiffness at the end of the step, M and c at its start,
    so that links whose inertia is small beside D h are stable.

    Args:
        command: u of each joint, held over a step. # (steps, n)
        step: h [s].
        gain: K [N m per unit of u].
        damping: D of each joint [N m s/rad].
        stiffness: S of each joint [N m/rad].
        links: what turns, rows of `serial_arm.link`. # (n, 36)

    Returns:
        Angle before each step [rad]; NaN after a divergence. # (steps, n)
    """
    out = np.full(command.shape, np.nan)
    given = np.ascontiguousarray(command, dtype=float)
    _simulate(given, step, gain, damping, stiffness, links, scratch(command.shape[1]), out)
    return out


@njit(cache=True)
def _simulate(
    command: np.ndarray,
    step: float,
    gain: float,
    damping: float,
    stiffness: float,
    links: np.ndarray,
    s: np.ndarray,
    out: np.ndarray,
) -> None:
    steps, n = command.shape
    angles = np.zeros(n)
    rates = np.zeros(n)
    nothing = np.zeros(n)
    matrix = np.zeros((n, n))
    bias = np.empty(n)
    added = step * damping + step * step * stiffness
    for k in range(steps):
        for i in range(n):
            if not abs(angles[i]) < 1e6:  # a turn count that no arm reaches
                return
            out[k, i] = angles[i]
        motion_equation(links, np.sin(angles), np.cos(angles), rates, nothing, s, matrix, bias)
        for i in range(n):
            push = gain * command[k, i] - bias[i] - damping * rates[i]
            bias[i] = step * (push - stiffness * (angles[i] + step * rates[i]))
            matrix[i, i] += added
        accelerations(links, matrix, bias)
        for i in range(n):
            rates[i] += bias[i]
            angles[i] += step * rates[i]
