"""Jacobians of one arm in its base frame: derivatives of the thesis's forward kinematics (5.3).

Equation (5.4) is the general 6 x 6 form, (D.1) the upper three rows written out for joints 1 to 5; both follow
here from each joint's axis and its distance to the point, dP/dq_i = a_i x (P - o_i), for any geometry.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import arm_geometry

Array = NDArray[np.float64]


def wrist_jacobian(angles: ArrayLike) -> Array:
    """Derivative of the wrist point (5.3) by joints 1 to 5: thesis (D.1), its misprints corrected.

    Args:
        angles: Joint angles 1 to 6 in rad, shape (..., 6).

    Returns:
        Matrices in m/rad, shape (..., 3, 5).

    Raises:
        InputError: The last dimension of `angles` is not 6.
    """
    return _columns(angles, np.zeros(3))[..., :3, :5]


def tool_jacobian(angles: ArrayLike) -> Array:
    """The 6 x 6 Jacobian (5.4) of the tool: velocity of the grasp point above, angular velocity below.

    Args:
        angles: Joint angles 1 to 6 in rad, shape (..., 6).

    Returns:
        Matrices, shape (..., 6, 6): rows 0 to 2 in m/rad, rows 3 to 5 without unit.

    Raises:
        InputError: The last dimension of `angles` is not 6.
    """
    return _columns(angles, arm_geometry().tool_vector)


def _columns(angles: ArrayLike, beyond: Array) -> Array:
    angles = np.asarray(angles, dtype=float)
    geometry = arm_geometry()
    joints = len(geometry.axes)
    if angles.ndim == 0 or angles.shape[-1] != joints:
        raise InputError(f"angles have shape {angles.shape}; the Jacobian needs (..., {joints}) in rad")
    rotation = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3))
    origin = np.broadcast_to(geometry.link_vectors[0], (*angles.shape[:-1], 3))
    axes, origins = [], []
    for joint, axis in enumerate(geometry.axes):
        axes.append(rotation[..., :, axis])
        origins.append(origin)
        rotation = rotation @ _turn(axis, angles[..., joint])
        origin = origin + rotation @ geometry.link_vectors[joint + 1]
    point = origin + rotation @ beyond
    columns = [
        np.concatenate([np.cross(a, point - o), a], axis=-1) for a, o in zip(axes, origins, strict=True)
    ]
    return np.stack(columns, axis=-1)


def _turn(axis: int, angle: Array) -> Array:
    """Rotation matrices of Table 5.2, shape (..., 3, 3)."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.zeros((*np.shape(angle), 3, 3))
    matrix[..., axis, axis] = 1.0
    matrix[..., first, first] = matrix[..., second, second] = np.cos(angle)
    matrix[..., second, first] = np.sin(angle)
    matrix[..., first, second] = -np.sin(angle)
    return matrix
