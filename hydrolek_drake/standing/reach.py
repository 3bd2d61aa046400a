"""Whether two arms can reach a grasp and a cut from a placement, by inverse kinematics alone: quick, for a map."""

import math
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.kinematics.chain import Chain, arm_chain
from hydrolek_drake.kinematics.direction_kernel import solve_direction
from hydrolek_drake.kinematics.frames import fixed_pose
from hydrolek_drake.kinematics.inverse import inverse_pose, inverse_position
from hydrolek_drake.kinematics.obstacles import ON_LIMIT
from hydrolek_drake.kinematics.position_kernel import solve_position
from hydrolek_drake.standing.base import Placement
from hydrolek_drake.standing.site import Site
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.plan import camera_in_world, other_side
from hydrolek_drake.vision.camera import camera_pose, thesis_camera
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.grasp import directions_onto
from hydrolek_drake.workcell.pipe import workcell_entries

Array = NDArray[np.float64]

_NO_AIM = np.zeros(3)
_ROUNDED = 6  # decimals of m: places of the pipe before the machine that count as one
_COARSER = 2  # than the planner's directions
_END_ON = 0.05  # sine of the angle between sight and pipe below which it has no side to grasp, as for vision


class Stage(IntEnum):
    """How far a placement comes, in the order of the checks."""

    GRASP_POINT = 0
    CUT_POINT = 1
    VIEW = 2
    GRASP = 3
    CUT = 4
    BASE = 5
    COLLISION = 6
    PATH = 7
    REACHED = 8

    def told(self) -> str:
        """What prevents a placement that came so far, and no farther."""
        return _TOLD[self]


_TOLD = {
    Stage.GRASP_POINT: "the arm that grasps cannot put its tool at the grasp",
    Stage.CUT_POINT: "the arm that cuts cannot put its tool before the cut",
    Stage.VIEW: "grasp and cut are not both in the camera's picture, or nearer or farther than it sees",
    Stage.GRASP: "the arm that grasps has no posture for its way onto the pipe",
    Stage.CUT: "the arm that cuts has no posture for its way across the pipe",
    Stage.BASE: "base or boom would touch something",
    Stage.COLLISION: "the arms would touch something",
    Stage.PATH: "no way for the arms from their first posture and back",
    Stage.REACHED: "nothing",
}


@dataclass(frozen=True)
class Reach:
    """What kinematics alone says of a placement.

    Attributes:
        stage: `Stage.REACHED`, or where it fails.
        margin: Smallest angle in rad between a joint of either arm and its stop, at the points that were solved for.
    """

    stage: Stage
    margin: float = 0.0


class ReachMap:
    """Reach from any placement; what looks alike from the machine is solved once.

    Args:
        site: Pipe and what stands around.
    """

    def __init__(self, site: Site) -> None:
        self._site = site
        self._known: dict[tuple[float, ...], Reach] = {}

    def of(self, placement: Placement, grasping: str) -> Reach:
        """Reach from a placement with one arm grasping."""
        key = self.key(placement, grasping)
        if key not in self._known:
            grasp, cut = self._seen(placement)
            self._known[key] = _reach(grasp, cut, self._site.pipe.radius, grasping)
        return self._known[key]

    def key(self, placement: Placement, grasping: str) -> tuple[float, ...]:
        """The same for placements from which the pipe looks alike."""
        grasp, cut = self._seen(placement)
        return (*np.round(grasp, _ROUNDED), *np.round(cut, _ROUNDED), float(grasping == "left"))

    def _seen(self, placement: Placement) -> tuple[Array, Array]:
        return placement.point_seen(self._site.grasp_point()), placement.point_seen(self._site.cut_point())


def in_picture(point: ArrayLike) -> bool:
    """Whether the camera sees a point of the arms' world frame within the depth that counts as reachable."""
    plate = fixed_pose("plate", "world")
    pose, camera = camera_pose(), thesis_camera()
    seen = (plate[:3, :3] @ np.asarray(point, dtype=float) + plate[:3, 3] - pose[:3, 3]) @ pose[:3, :3]
    if not kinect_entries("camera")["nearest"] <= seen[2] <= kinect_entries("edges")["farthest"]:
        return False
    u, v = camera.pixel(seen)
    border = teleop_entries("task")["border"]
    return bool(min(u, v, camera.width - 1 - u, camera.height - 1 - v) >= border)


def why_not(site: Site, placement: Placement, grasping: str) -> str:
    """The figures behind a placement that fails: the inverse kinematics' own reason."""
    stage = ReachMap(site).of(placement, grasping).stage
    side = grasping if stage in (Stage.GRASP_POINT, Stage.GRASP) else other_side(grasping)
    grasp, cut = (placement.point_seen(each) for each in (site.grasp_point(), site.cut_point()))
    sight = grasp - camera_in_world()
    axis = (cut - grasp) / np.linalg.norm(cut - grasp)
    blade = kinect_entries("targets")["blade_reach"]
    square = directions_onto(axis, sight)[0][1]
    target = grasp if side == grasping else cut - blade * square
    pose = fixed_pose(f"{side}_base", "world")
    there, aim = pose[:3, :3] @ target + pose[:3, 3], pose[:3, :3] @ square
    return inverse_position(there, side).reason or inverse_pose(there, aim, side).reason


def _reach(grasp: Array, cut: Array, radius: float, grasping: str) -> Reach:
    """Grasp and cut in the arms' world frame."""
    axis, sight = cut - grasp, grasp - camera_in_world()
    axis /= np.linalg.norm(axis)
    values, sizes = workcell_entries()["grasp"], kinect_entries("targets")
    blade = sizes["blade_reach"]
    holder, cutter = arm_chain(grasping), arm_chain(other_side(grasping))
    if not _spans(holder, grasp, 0.0) or not _at(holder, grasp):
        return Reach(Stage.GRASP_POINT)
    if not _spans(cutter, cut, blade):
        return Reach(Stage.CUT_POINT)
    if not (in_picture(grasp) and in_picture(cut)):
        return Reach(Stage.VIEW)
    if np.linalg.norm(np.cross(axis, sight / np.linalg.norm(sight))) < _END_ON:
        return Reach(Stage.GRASP)
    directions = np.array([each for _, each in directions_onto(axis, sight, coarser=_COARSER)])
    across = np.cross(axis, directions)
    across /= np.linalg.norm(across, axis=1)[:, np.newaxis]
    enter, distance = math.radians(values["enter_deg"]), radius + sizes["approach"] + values["farther"]
    before = -distance * (math.cos(enter) * directions)
    beside = distance * math.sin(enter) * across
    there = np.broadcast_to(grasp, directions.shape)
    points = np.stack([there, grasp + before - beside, grasp + before + beside], axis=1)
    held = _first(holder, points, directions, any_of_rest=True)
    if held < 0.0:
        return Reach(Stage.GRASP)
    reach = radius + sizes["clearance"]
    middle = cut - blade * directions
    points = np.stack([middle, middle - reach * across, middle + reach * across], axis=1)
    cuts = _first(cutter, points, directions, any_of_rest=False)
    if cuts < 0.0:
        return Reach(Stage.CUT)
    return Reach(Stage.REACHED, min(held, cuts))


def _spans(chain: Chain, point: Array, less: float) -> bool:
    """Whether the stretched links are long enough; `less` is how far before the point the tool may stop."""
    longest = float(np.sum(np.hypot(chain.links[:, 0], chain.links[:, 1])))
    pose = fixed_pose("world", f"{chain.side}_base")
    return bool(np.linalg.norm(point - pose[:3, 3]) <= longest + less)


def _at(chain: Chain, point: Array) -> bool:
    pose = fixed_pose(f"{chain.side}_base", "world")
    target = pose[:3, :3] @ point + pose[:3, 3] - chain.base
    q = np.empty(8)
    return bool(
        solve_position(target, chain.links, chain.limits, ON_LIMIT, chain.middle[:5], _NO_AIM, q) == 0.0
    )


def _first(chain: Chain, points: Array, directions: Array, *, any_of_rest: bool) -> float:
    """Margin in rad of the first direction from which its points (n, k, 3) are reached; -1 if none.

    Args:
        chain: The arm.
        points: Of its tool, world frame, in m.
        directions: Of its tool, world frame, shape (n, 3).
        any_of_rest: Whether one of those behind the first point is enough.
    """
    pose = fixed_pose(f"{chain.side}_base", "world")
    targets = np.ascontiguousarray(points @ pose[:3, :3].T + pose[:3, 3] - chain.base)
    aims = directions @ pose[:3, :3].T
    return float(_first_reached(targets, aims, any_of_rest, chain.links, chain.limits, ON_LIMIT))


@njit(cache=True)
def _first_reached(
    targets: Any, aims: Any, any_of_rest: bool, links: Any, limits: Any, tolerance: float
) -> float:
    found = np.empty((32, 5))
    for i in range(aims.shape[0]):
        least, most_of_rest = np.inf, -1.0
        for j in range(targets.shape[1]):
            count = solve_direction(targets[i, j], aims[i], links, limits, tolerance, found)
            best = -1.0
            for row in range(count):
                margin = np.inf
                for joint in range(5):
                    margin = min(
                        margin, found[row, joint] - limits[0, joint], limits[1, joint] - found[row, joint]
                    )
                best = max(best, margin)
            if any_of_rest and j > 0:
                most_of_rest = max(most_of_rest, best)
            else:
                least = min(least, best)
                if count == 0:
                    break
        if any_of_rest:
            least = min(least, most_of_rest)
        if least >= 0.0:
            return least
    return -1.0
