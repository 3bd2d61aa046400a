"""Both hands on one rigid object: paths of the object, joints that follow it, and how far the chain is from closed.

With X_WO the object's pose and X_OT the constant place of a tool T on it, each hand must be at X_WT = X_WO X_OT. An
arm has six joints for six degrees of freedom, so its joints follow in closed form (`kinematics.inverse`), and the two
arms' relative pose (X_WR)^-1 X_WL must stay what it was when they took the object.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RotationMatrix

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import fixed_pose
from hydrolek_drake.kinematics.inverse import inverse_pose

Array = NDArray[np.float64]

_BRANCH = 0.5  # rad between neighbouring postures: more is another branch of the inverse kinematics
_LONGEST = 10_000  # steps of a path
_TURNED = 1e-6  # largest entry by which a tool's attitude may miss the wanted one


@dataclass(frozen=True)
class Hold:
    """Where both hands hold an object: poses of the tools in its frame, X_OT, each of shape (4, 4).

    Attributes:
        right: Of the right tool.
        left: Of the left one.
    """

    right: Array
    left: Array

    def relative(self) -> Array:
        """Pose of the left tool in the right one, which stays while both hold, shape (4, 4)."""
        return np.asarray(np.linalg.inv(self.right) @ self.left)


def tools_at(postures: ArrayLike) -> tuple[Array, Array]:
    """Poses of the right and the left tool in the world frame, each of shape (n, 4, 4).

    Args:
        postures: Joints `right_j1` ... `left_j7` in rad, shape (n, 14).
    """
    angles = np.atleast_2d(np.asarray(postures, dtype=float))
    right, left = (
        fixed_pose("world", f"{side}_base") @ tool_pose(angles[:, 7 * index : 7 * index + 6])
        for index, side in enumerate(SIDES)
    )
    return right, left


def hold_at(posture: ArrayLike, pose: ArrayLike) -> Hold:
    """The hold of hands that are at a posture, shape (14,), on an object at a pose, shape (4, 4)."""
    inverse = np.linalg.inv(np.asarray(pose, dtype=float))
    right, left = tools_at(posture)
    return Hold(inverse @ right[0], inverse @ left[0])


def object_path(pose: ArrayLike, shift: ArrayLike, axis: ArrayLike, angle: float, step: float) -> Array:
    """Poses of an object that moves straight and turns about its own origin at the same time, shape (n, 4, 4).

    Args:
        pose: At first, world frame, shape (4, 4).
        shift: Of its origin, world frame, in m, shape (3,).
        axis: That it turns about, world frame, shape (3,); any if it does not turn.
        angle: By which it turns, in rad.
        step: Distance of neighbouring poses at most: in m, and in rad by a lever of 1 m.

    Raises:
        InputError: A turn about an axis without length, or numbers that are not finite.
    """
    start, way, line = (np.asarray(each, dtype=float) for each in (pose, shift, axis))
    if way.shape != (3,) or line.shape != (3,) or not np.isfinite([*way, *line, angle]).all():
        raise InputError("the object's way needs three finite numbers for shift and axis, and a finite angle")
    length = float(np.linalg.norm(line))
    if angle and length < 1e-9:
        raise InputError(
            "the object is to turn about an axis without length; give three numbers, not all zero"
        )
    if max(float(np.linalg.norm(way)), abs(angle)) > _LONGEST * step:
        raise InputError(
            f"the object is to go {np.linalg.norm(way):.3g} m and turn {abs(angle):.3g} rad; no arm reaches so far"
        )
    count = max(2, int(np.ceil(max(float(np.linalg.norm(way)), abs(angle)) / step)) + 1)
    path = np.tile(start, (count, 1, 1))
    for index, share in enumerate(np.linspace(0.0, 1.0, count)):
        if angle:
            turn = RotationMatrix(AngleAxis(share * angle, line / length)).matrix()
            path[index, :3, :3] = turn @ start[:3, :3]
        path[index, :3, 3] = start[:3, 3] + share * way
    return path


def follow(path: ArrayLike, hold: Hold, near: ArrayLike) -> Array:
    """Joints of both arms whose hands stay where they hold the object along its path.

    Args:
        path: Poses of the object, world frame, shape (n, 4, 4).
        hold: Where the hands hold it.
        near: Posture to begin near to, in rad, shape (14,); joints 7 stay as they are in it.

    Returns:
        Postures, shape (n, 14).

    Raises:
        InputError: An arm cannot; says which, how far along the path, and why.
    """
    poses, first = np.asarray(path, dtype=float), np.asarray(near, dtype=float)
    postures = np.tile(first, (len(poses), 1))
    for index, side in enumerate(SIDES):
        arm = slice(7 * index, 7 * index + 6)
        base, grasp = fixed_pose(f"{side}_base", "world"), getattr(hold, side)
        before = first[arm]
        for row, pose in enumerate(poses):
            wanted = base @ pose @ grasp
            share = 100.0 * row / max(1, len(poses) - 1)
            result = inverse_pose(wanted[:3, 3], wanted[:3, 0], side, jaw_axis=wanted[:3, 2], near=before)
            if not result.reached:
                raise InputError(f"after {share:.0f} % of the way {result.reason}")
            angles = result.angles[0]
            if np.max(np.abs(tool_pose(angles)[:3, :3] - wanted[:3, :3])) > _TURNED:
                angles = np.array(angles)  # the jaws' axis alone is the same either way round
                angles[5] += np.pi if angles[5] < before[5] else -np.pi
            if row and np.max(np.abs(angles - before)) > _BRANCH:
                raise InputError(
                    f"after {share:.0f} % of the way the {side} arm would have to jump to another posture"
                )
            postures[row, arm] = before = angles
    return postures


def chain_error(postures: ArrayLike, hold: Hold) -> tuple[Array, Array]:
    """How far the hands are from where they hold a rigid object, for each posture.

    The left tool's pose in the right one, against that of the hold: distance of its origins and angle between its
    attitudes. With the chain closed both are zero; a rigid object makes forces of what they are not.

    Args:
        postures: Shape (n, 14), in rad.
        hold: Where the hands hold it.

    Returns:
        In m and in rad, each of shape (n,).
    """
    right, left = tools_at(postures)
    amiss = np.linalg.inv(hold.relative()) @ np.linalg.inv(right) @ left
    # the sine's form, since the cosine's resolves no angle below 1e-8
    turn = (
        0.5
        * np.linalg.norm(amiss[:, :3, :3] - np.swapaxes(amiss[:, :3, :3], 1, 2), axis=(1, 2))
        / np.sqrt(2.0)
    )
    cosine = 0.5 * (np.trace(amiss[:, :3, :3], axis1=1, axis2=2) - 1.0)
    return np.linalg.norm(amiss[:, :3, 3], axis=1), np.arctan2(turn, cosine)
