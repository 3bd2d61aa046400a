"""Forward kinematics of one arm in its base frame (X forward, Y up, Z to the right)."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ArmGeometry:
    """Link vectors and joint axes of the chain in thesis equation (5.3).

    Attributes:
        link_vectors: L0 to L6 in m, shape (7, 3).
        axes: Index of each joint's axis, 0 for X, 1 for Y, 2 for Z; joints 1 to 6.
        gripper_axis: Axis of joint 7, the moving jaw, in the frame of joint 6.
        tool_vector: Grasp point in the frame of joint 6, in m, shape (3,).
    """

    link_vectors: Array
    axes: tuple[int, ...]
    gripper_axis: int
    tool_vector: Array


@cache
def arm_geometry() -> ArmGeometry:
    """The geometry in `arm_geometry.yaml` (thesis Tables 5.1 and 5.2), in SI units."""
    data = package_yaml(__package__, "arm_geometry.yaml")

    def in_metres(entry: str) -> Array:
        vectors = np.array(data[entry]["value"], dtype=float) * si_factor(data[entry]["unit"], "m")
        vectors.flags.writeable = False  # shared by all callers through the cache
        return vectors

    return ArmGeometry(
        link_vectors=in_metres("link_vectors"),
        axes=tuple("XYZ".index(axis) for axis in data["joint_axes"]["value"]),
        gripper_axis="XYZ".index(data["gripper_axis"]["value"]),
        tool_vector=in_metres("tool_vector"),
    )


def wrist_position(angles: ArrayLike) -> Array:
    """Position of the wrist point, the origin of joint 6's frame, in the arm base frame.

    P = L0 + R1 (L1 + R2 (L2 + R3 (L3 + R4 (L4 + R5 (L5 + R6 L6))))), thesis equation (5.3). R6 is a
    rotation about X here, not the identity that Table 5.2 prints; since L6 = 0, P is the same.

    Args:
        angles: Joint angles 1 to 6 in rad, shape (..., 6).

    Returns:
        Position in m, shape (..., 3).

    Raises:
        InputError: The last dimension of `angles` is not 6.
    """
    angles = _checked(angles)
    geometry = arm_geometry()
    position = np.broadcast_to(geometry.link_vectors[-1], (*angles.shape[:-1], 3))
    for joint in reversed(range(len(geometry.axes))):
        position = geometry.link_vectors[joint] + _rotated(position, geometry.axes[joint], angles[..., joint])
    return position


def joint_positions(angles: ArrayLike) -> Array:
    """Origins of the joints' frames and the tool in the arm base frame, (5.3) broken off after each link.

    Args:
        angles: Joint angles 1 to 6 in rad, shape (..., 6).

    Returns:
        Positions in m, joint 1 first, the tool last, shape (..., 8, 3); the last but one is the wrist point.

    Raises:
        InputError: The last dimension of `angles` is not 6.
    """
    angles = _checked(angles)
    geometry, found = arm_geometry(), []
    for last in range(len(geometry.link_vectors)):
        position = np.broadcast_to(geometry.link_vectors[last], (*angles.shape[:-1], 3))
        for joint in reversed(range(last)):
            position = geometry.link_vectors[joint] + _rotated(
                position, geometry.axes[joint], angles[..., joint]
            )
        found.append(position)
    found.append(tool_pose(angles)[..., :3, 3])
    return np.stack(found, axis=-2)


def tool_pose(angles: ArrayLike) -> Array:
    """Pose of the tool frame, the grasp point between the jaws, in the arm base frame.

    Its rotation is R1 R2 R3 R4 R5 R6; its origin lies the tool vector beyond the wrist point.

    Args:
        angles: Joint angles 1 to 6 in rad, shape (..., 6).

    Returns:
        Homogeneous transforms, shape (..., 4, 4), translation in m.

    Raises:
        InputError: The last dimension of `angles` is not 6.
    """
    angles = _checked(angles)
    geometry = arm_geometry()
    columns = np.broadcast_to(np.eye(3), (*angles.shape[:-1], 3, 3))  # row i: the image of unit vector i
    for joint in reversed(range(len(geometry.axes))):
        columns = _rotated(columns, geometry.axes[joint], angles[..., joint, np.newaxis])
    pose = np.zeros((*angles.shape[:-1], 4, 4))
    pose[..., :3, :3] = np.swapaxes(columns, -1, -2)
    pose[..., :3, 3] = wrist_position(angles) + pose[..., :3, :3] @ geometry.tool_vector
    pose[..., 3, 3] = 1.0
    return pose


def _rotated(vectors: Array, axis: int, angle: Array) -> Array:
    """`vectors` (..., 3) turned about a coordinate axis by `angle` (...), right-handed."""
    first, second = (axis + 1) % 3, (axis + 2) % 3
    cosine, sine = np.cos(angle), np.sin(angle)
    turned = np.empty(np.broadcast_shapes(vectors.shape, (*np.shape(angle), 3)))
    turned[..., axis] = vectors[..., axis]
    turned[..., first] = cosine * vectors[..., first] - sine * vectors[..., second]
    turned[..., second] = sine * vectors[..., first] + cosine * vectors[..., second]
    return turned


def _checked(angles: ArrayLike) -> Array:
    array = np.asarray(angles, dtype=float)
    joints = len(arm_geometry().axes)
    if array.ndim == 0 or array.shape[-1] != joints:
        raise InputError(f"angles have shape {array.shape}; forward kinematics needs (..., {joints}) in rad")
    return array
