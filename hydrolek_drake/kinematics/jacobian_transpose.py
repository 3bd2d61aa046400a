"""The thesis's iterative inverse kinematics by the Jacobian's transpose, (5.5) to (5.7).

Kept to compare with: it may get stuck, knows nothing of joint limits unless they clamp it, and needs thousands
of steps for small tolerances (Table 5.3). `inverse.py` is what the rest of the package uses.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import arm_chain
from hydrolek_drake.kinematics.compiled_forward import point_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TransposeResult:
    """Where the iteration ended.

    Attributes:
        angles: Joints 1 to 6 in rad, shape (6,); joint 6 is that of the start.
        error: Distance from the target in m.
        iterations: Steps taken.
        converged: Whether the error is within the tolerance.
    """

    angles: Array
    error: float
    iterations: int
    converged: bool


def jacobian_transpose(
    position: ArrayLike,
    start: ArrayLike,
    *,
    side: str = "right",
    point: str = "wrist",
    tolerance: float,
    most_iterations: int,
    clamped: bool = True,
) -> TransposeResult:
    """Step by d(theta) = alpha J^T dP (5.6) until the point is within `tolerance` of the target.

    alpha = (|J^T dP| / |J J^T dP|)^2 (5.7) is computed anew in each step; it makes the linear prediction (5.5)
    of the remaining distance smallest along the step.

    Args:
        position: Target in the arm base frame, in m, shape (3,).
        start: Joints 1 to 6 to start from, in rad, shape (6,).
        side: `right` or `left`.
        point: `wrist` as in the thesis, or `tool`.
        tolerance: Distance from the target to stop at, in m.
        most_iterations: Steps to give up after.
        clamped: Whether each step ends at the joint limits.

    Raises:
        InputError: Unknown arm or point, wrong shapes, or a tolerance that is not positive.
    """
    chain = arm_chain(side, point)
    target, angles = np.asarray(position, dtype=float), np.array(start, dtype=float)
    if target.shape != (3,) or angles.shape != (6,):
        raise InputError(f"position has shape {target.shape}, start {angles.shape}; use (3,) and (6,)")
    if not tolerance > 0.0:
        raise InputError(f"tolerance is {tolerance} m; use a positive distance")
    limits = np.array([chain.lower[:5], chain.upper[:5]])
    if not clamped:
        limits = np.array([np.full(5, -np.inf), np.full(5, np.inf)])
    joints = angles[:5].copy()
    iterations, error = _iterate(
        target - chain.base, joints, chain.links.copy(), limits, tolerance, most_iterations
    )
    angles[:5] = joints
    return TransposeResult(angles, error, iterations, error <= tolerance)


@njit(cache=True)
def _iterate(
    target: Any, q: Any, links: Any, limits: Any, tolerance: float, most_iterations: int
) -> tuple[int, float]:
    reached, jacobian = np.empty(3), np.empty((3, 5))
    iterations = 0
    while True:
        point_of(q, links, reached)
        miss = target - reached
        error = math.sqrt(miss[0] ** 2 + miss[1] ** 2 + miss[2] ** 2)
        if error <= tolerance or iterations >= most_iterations:
            return iterations, error
        _fill(q, links, reached, jacobian)
        step = jacobian.T @ miss
        moved = jacobian @ step
        bottom = moved[0] ** 2 + moved[1] ** 2 + moved[2] ** 2
        if bottom < 1e-30:  # the target lies where no joint moves to: stuck
            return iterations, error
        alpha = np.sum(step**2) / bottom
        for joint in range(5):
            q[joint] = min(max(q[joint] + alpha * step[joint], limits[0, joint]), limits[1, joint])
        iterations += 1


@njit(cache=True)
def _fill(q: Any, links: Any, point: Any, jacobian: Any) -> None:
    """(D.1): each column is the joint's axis times the vector from the joint to the point."""
    c1, s1 = math.cos(q[0]), math.sin(q[0])
    # in the frame turned by joint 1, then turned back
    x, y, z = c1 * point[0] - s1 * point[2], point[1], s1 * point[0] + c1 * point[2]
    a = q[1] + q[2]
    ca, sa, c4, s4 = math.cos(a), math.sin(a), math.cos(q[3]), math.sin(q[3])
    x2, y2 = links[0, 0], links[0, 1]
    x3 = x2 + math.cos(q[1]) * links[1, 0] - math.sin(q[1]) * links[1, 1]
    y3 = y2 + math.sin(q[1]) * links[1, 0] + math.cos(q[1]) * links[1, 1]
    x4 = x3 + ca * links[2, 0] - sa * links[2, 1]
    y4 = y3 + sa * links[2, 0] + ca * links[2, 1]
    x5 = x4 + ca * c4 * links[3, 0] - sa * links[3, 1]
    y5 = y4 + sa * c4 * links[3, 0] + ca * links[3, 1]
    z5 = -s4 * links[3, 0]
    _column(jacobian, 0, 0.0, 1.0, 0.0, x, y, z)
    _column(jacobian, 1, 0.0, 0.0, 1.0, x - x2, y - y2, z)
    _column(jacobian, 2, 0.0, 0.0, 1.0, x - x3, y - y3, z)
    _column(jacobian, 3, -sa, ca, 0.0, x - x4, y - y4, z)
    _column(jacobian, 4, ca * s4, sa * s4, c4, x - x5, y - y5, z - z5)
    for joint in range(5):
        turned = c1 * jacobian[0, joint] + s1 * jacobian[2, joint]
        jacobian[2, joint] = -s1 * jacobian[0, joint] + c1 * jacobian[2, joint]
        jacobian[0, joint] = turned


@njit(cache=True)
def _column(
    jacobian: Any, joint: int, a_x: float, a_y: float, a_z: float, x: float, y: float, z: float
) -> None:
    jacobian[0, joint] = a_y * z - a_z * y
    jacobian[1, joint] = a_z * x - a_x * z
    jacobian[2, joint] = a_x * y - a_y * x
