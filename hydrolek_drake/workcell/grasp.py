"""Postures for grasping and cutting a pipe: from which side, and whether the arm can."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import direction_in_frame, fixed_pose, in_frame
from hydrolek_drake.kinematics.inverse import inverse_pose, inverse_position
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.pipe import workcell_entries

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ToolPath:
    """Postures of one arm along a straight path of its tool with a fixed direction.

    Attributes:
        side: `right` or `left`.
        angles: Joints 1 to 6 in rad, shape (n, 6).
        direction: Of the tool in the world frame, unit vector, shape (3,).
        points: Of the tool in the world frame, in m, shape (n, 3).
        tilt: Angle off square to the pipe in rad.
    """

    side: str
    angles: Array
    direction: Array
    points: Array
    tilt: float


def directions_onto(axis: ArrayLike, sight: ArrayLike, *, coarser: int = 1) -> list[tuple[float, Array]]:
    """Tool directions onto a pipe, best first: square and from the camera's side before turned and tilted ones.

    Args:
        axis: Of the pipe, world frame, unit vector, shape (3,).
        sight: From the camera to the pipe, world frame, shape (3,); not along the axis.
        coarser: Only every n-th turn around the pipe and tilt off square, for a first look.

    Returns:
        Pairs of tilt off square in rad and unit vector.
    """
    values = workcell_entries()["grasp"]
    axis, sight = np.asarray(axis, dtype=float), np.asarray(sight, dtype=float)
    square = sight - (sight @ axis) * axis
    square /= np.linalg.norm(square)
    across = np.cross(axis, square)
    most, step = values["turn_most_deg"], values["turn_step_deg"]
    finest = min(abs(tilt) for tilt in values["tilt_deg"] if tilt)
    tilts = [tilt for tilt in values["tilt_deg"] if coarser == 1 or tilt % (coarser * finest) == 0]
    choices = [
        (abs(turn) + values["tilt_cost"] * abs(tilt), turn, tilt)
        for turn in range(-int(most), int(most) + 1, int(step) * coarser)
        for tilt in tilts
    ]
    found = []
    for _, turn, tilt in sorted(choices, key=lambda choice: choice[0]):
        flat = math.cos(math.radians(turn)) * square + math.sin(math.radians(turn)) * across
        found.append(
            (math.radians(tilt), math.cos(math.radians(tilt)) * flat + math.sin(math.radians(tilt)) * axis)
        )
    return found


def straight_path(
    side: str, start: ArrayLike, end: ArrayLike, direction: ArrayLike, jaw_axis: ArrayLike, near: ArrayLike
) -> Array | None:
    """Joints 1 to 6 along a straight line of the tool, or None where a point cannot be had in one branch.

    Args:
        side: `right` or `left`.
        start: World frame, in m, shape (3,).
        end: Likewise.
        direction: Of the tool, world frame.
        jaw_axis: Line that the jaws' axis is turned parallel to, world frame.
        near: Joints 1 to 6 to begin near to, in rad, shape (6,).
    """
    base = f"{side}_base"
    first, last = (in_frame(point, given_in="world", wanted_in=base) for point in (start, end))
    aim = direction_in_frame(direction, given_in="world", wanted_in=base)
    line = direction_in_frame(jaw_axis, given_in="world", wanted_in=base)
    step = workcell_entries()["grasp"]["path_step"]
    count = max(2, math.ceil(float(np.linalg.norm(last - first)) / step) + 1)
    angles: list[Array] = []
    for share in np.linspace(0.0, 1.0, count):
        result = inverse_pose(
            first + share * (last - first),
            aim,
            side,
            jaw_axis=line,
            near=angles[-1] if angles else near,
            explain=False,
        )
        if not result.reached:
            return None
        if angles and np.max(np.abs(result.angles[0] - angles[-1])) > 0.5:  # another branch
            return None
        angles.append(result.angles[0])
    return np.array(angles)


def grasp_paths(
    point: ArrayLike,
    axis: ArrayLike,
    sight: ArrayLike,
    distance: float,
    posture: Array,
    side: str,
    clear: CollisionWorld,
    holding: CollisionWorld,
) -> Iterator[ToolPath]:
    """From in front of the pipe onto it, with the jaws open, past the bent tips of the fixed fingers.

    Args:
        point: To grasp, on the pipe's axis, world frame, in m.
        axis: Of the pipe.
        sight: From the camera to the pipe.
        distance: How far in front of `point` the path begins, in m.
        posture: Both arms as they stand, shape (14,).
        side: Arm that grasps.
        clear: Collisions where nothing may touch.
        holding: Collisions on the way, of a pipe that this gripper may touch or that is as much thinner.

    Yields:
        All ways, best first; at least one.

    Raises:
        InputError: No direction works; says why.
    """
    found = False
    opened = _with_jaw(posture, side, workcell_entries()["grasp"]["open_deg"])
    point = np.asarray(point, dtype=float)
    blocked = ""
    enter = math.radians(workcell_entries()["grasp"]["enter_deg"])
    for tilt, direction in directions_onto(axis, sight):
        across = np.cross(np.asarray(axis, dtype=float), direction)
        across /= np.linalg.norm(across)
        for turned, way in ((0.0, 1.0), (0.0, -1.0), (math.pi, 1.0), (math.pi, -1.0)):  # either way round
            start = point - distance * (math.cos(enter) * direction + way * math.sin(enter) * across)
            near = np.array(opened[_arm(side)][:6])
            near[5] += turned
            angles = straight_path(side, start, point, direction, axis, near)
            if angles is None:
                continue
            postures = [with_arm(opened, side, row) for row in angles]
            if not clear.free(postures[0]):
                blocked = f"{clear.what_touches(postures[0])} would touch in front of it"
                continue
            stuck = next((each for each in postures if not holding.free(each)), None)
            if stuck is not None:
                blocked = f"{holding.what_touches(stuck)} would touch on the way"
                continue
            points = start + np.linspace(0, 1, len(angles))[:, np.newaxis] * (point - start)
            found = True
            yield ToolPath(side, angles, direction, points, tilt)
    if not found:
        raise InputError(_why(side, point, blocked, "grasp"))


def cut_path(
    point: ArrayLike,
    axis: ArrayLike,
    sight: ArrayLike,
    reach: float,
    blade: float,
    posture: Array,
    side: str,
    clear: CollisionWorld,
) -> ToolPath:
    """Across the pipe, square to it, with the blade before the closed jaws.

    Args:
        point: To cut, on the pipe's axis, world frame, in m.
        axis: Of the pipe.
        sight: From the camera to the pipe.
        reach: How far the cut goes to either side of the axis, in m.
        blade: How far the blade's cutting point lies before the tool point, in m.
        posture: Both arms as they stand, shape (14,).
        side: Arm that cuts.
        clear: Collisions of all but what this posture holds.

    Raises:
        InputError: No direction works; says why.
    """
    closed = _with_jaw(posture, side, workcell_entries()["grasp"]["closed_deg"])
    point, blocked = np.asarray(point, dtype=float), ""
    for tilt, direction in directions_onto(axis, sight):
        across = np.cross(np.asarray(axis, dtype=float), direction)
        across /= np.linalg.norm(across)
        for way in (1.0, -1.0):
            ends = [point - blade * direction + sign * way * reach * across for sign in (-1.0, 1.0)]
            angles = straight_path(side, ends[0], ends[1], direction, axis, closed[_arm(side)][:6])
            if angles is None:
                continue
            postures = [with_arm(closed, side, row) for row in angles]
            stuck = next((each for each in postures if not clear.free(each)), None)
            if stuck is not None:
                blocked = f"{clear.what_touches(stuck)} would touch"
                continue
            points = ends[0] + np.linspace(0, 1, len(angles))[:, np.newaxis] * (ends[1] - ends[0])
            return ToolPath(side, angles, direction, points, tilt)
    raise InputError(_why(side, point - blade * np.asarray(sight) / np.linalg.norm(sight), blocked, "cut"))


def with_arm(posture: Array, side: str, angles: Array) -> Array:
    """The posture with joints 1 to 6 of one arm replaced, shape (14,)."""
    changed = np.array(posture, dtype=float)
    changed[_arm(side)][:6] = angles
    return changed


def tool_in_world(posture: Array, side: str) -> tuple[Array, Array]:
    """Rotation matrix (3, 3) and position in m (3,) of a tool, both arms at `posture`, shape (14,)."""
    pose = fixed_pose("world", f"{side}_base") @ tool_pose(posture[_arm(side)][:6])
    return pose[:3, :3], pose[:3, 3]


def _with_jaw(posture: Array, side: str, degrees: float) -> Array:
    changed = np.array(posture, dtype=float)
    changed[_arm(side)][6] = math.radians(degrees)
    return changed


def with_jaw(posture: Array, side: str, angle: float) -> Array:
    """The posture with one gripper at `angle` in rad, shape (14,)."""
    return _with_jaw(posture, side, math.degrees(angle))


def _arm(side: str) -> slice:
    begin = 7 * SIDES.index(side)
    return slice(begin, begin + 7)


def _why(side: str, point: Array, blocked: str, task: str) -> str:
    if blocked:
        return f"the {side} arm cannot {task} there: {blocked}; choose another point"
    alone = inverse_position(in_frame(point, given_in="world", wanted_in=f"{side}_base"), side)
    reason = alone.reason or "it cannot point its tool onto the pipe there within its strokes"
    return f"the {side} arm cannot {task} there: {reason}; choose another point or move the machine"
