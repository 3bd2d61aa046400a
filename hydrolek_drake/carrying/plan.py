"""Plan for both arms to take a pipe and move it: ways onto it, and the closed chain's path."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.teleop.plan import camera_in_world, thinner
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.closed_chain import Hold, follow, hold_at, object_path
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import ToolPath, grasp_paths, with_arm, with_jaw
from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries
from hydrolek_drake.workcell.planner import plan_path
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.trajectory import smooth_trajectory
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Move:
    """Where a pipe is to be moved.

    Attributes:
        shift: Of its middle, world frame, in m, shape (3,).
        axis: That it turns about, through its middle, world frame, shape (3,).
        angle: By which it turns, in rad.
    """

    shift: Array
    axis: Array
    angle: float

    def path(self, pose: ArrayLike) -> Array:
        """Poses of the pipe from one at first, shape (n, 4, 4)."""
        return object_path(pose, self.shift, self.axis, self.angle, carry_entries("move")["step"])


@dataclass(frozen=True)
class CarryPlan:
    """Both arms take a pipe and move it.

    Attributes:
        pipe: Where it is at first, world frame.
        move: What is done with it.
        approach: Postures from the first one to where both open grippers are around the pipe, shape (n, 14).
        grasp: Posture there with both grippers closed, shape (14,).
        hold: Where the hands hold the pipe.
        postures: Along the pipe's path, shape (m, 14).
    """

    pipe: Pipe
    move: Move
    approach: Array
    grasp: Array
    hold: Hold
    postures: Array

    def trajectory(self, postures: Array | None = None) -> Any:
        """The pipe's way in time: within the joints' speeds and the hands' speed; 14 rows from time 0.

        Args:
            postures: Others along the same path, such as those from where the arms really are; `postures` if None.
        """
        return in_time(self.postures if postures is None else postures, self.move)


@cache
def carry_entries(part: str) -> dict[str, Any]:
    """Name -> value of a part of `carry.yaml`."""
    return {name: entry["value"] for name, entry in package_yaml(__package__, "carry.yaml")[part].items()}


def pipe_to_carry(
    point: ArrayLike | None = None, axis: ArrayLike | None = None, length: float | None = None
) -> Pipe:
    """A pipe; what is not given is that of `carry.yaml`."""
    values = carry_entries("pipe")
    return make_pipe(
        values["point"] if point is None else point,
        values["axis"] if axis is None else axis,
        length=values["length"] if length is None else length,
    )


def pose_of(pipe: Pipe) -> Array:
    """Of a pipe's middle and axis, world frame, shape (4, 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = pipe.rotation(), pipe.point
    return pose


def in_time(postures: Array, move: Move) -> Any:
    """A path of postures as a trajectory, no faster than joints and hands may move."""
    trajectory, values = smooth_trajectory(postures), carry_entries("move")
    way = float(np.linalg.norm(move.shift)) + abs(move.angle) * carry_entries("pipe")["apart"]
    least = 1.5 * way / values["speed"]  # it starts and ends at rest
    if trajectory.end_time() < least:
        trajectory.ScaleTime(least / trajectory.end_time())
    return trajectory


def plan_carry(
    pipe: Pipe,
    move: Move,
    generator: np.random.Generator,
    *,
    apart: float | None = None,
    posture: ArrayLike | None = None,
    on_step: Any = lambda name: None,
) -> CarryPlan:
    """Find how both arms take a pipe so that they can move it as wanted.

    Args:
        pipe: Where it is, world frame.
        move: Where it shall be moved.
        generator: For the path planner.
        apart: Distance in m of each hand from the pipe's middle; that of `carry.yaml` if None.
        posture: Both arms as they stand, in rad, shape (14,); at home if None.
        on_step: Called with each step's name before it is planned.

    Raises:
        InputError: An arm cannot grasp there, no pair of grasps can move the pipe so, or no path; says why.
    """
    start = home_posture() if posture is None else np.asarray(posture, dtype=float)
    aside = carry_entries("pipe")["apart"] if apart is None else apart
    if not 0.0 < aside < 0.5 * pipe.length:
        raise InputError(
            f"the hands at {aside:g} m from the pipe's middle are beyond its ends; it is {pipe.length:g} m long"
        )
    values = workcell_entries()["grasp"]
    clear, touching = CollisionWorld(pipe), CollisionWorld(thinner(pipe), padding=0.0)
    held = CollisionWorld(pipe, holding=SIDES)
    distance = pipe.radius + kinect_entries("targets")["approach"] + values["farther"]
    to_the_left = 1.0 if pipe.axis[1] >= 0.0 else -1.0
    ways: list[list[ToolPath]] = []
    for side, sign in (("right", -to_the_left), ("left", to_the_left)):
        on_step(f"grasp, {side} arm")
        point = pipe.point + sign * aside * pipe.axis
        found = grasp_paths(
            point, pipe.axis, point - camera_in_world(), distance, start, side, clear, touching
        )
        ways.append(list(itertools.islice(found, math.isqrt(int(carry_entries("move")["most_pairs"])))))
    on_step("path of the pipe")
    path, refusal = move.path(pose_of(pipe)), ""
    for right, left in _pairs(*ways):
        both = with_arm(with_arm(start, "right", right.angles[-1]), "left", left.angles[-1])
        for side in SIDES:
            both = with_jaw(both, side, math.radians(values["closed_deg"]))
        hold = hold_at(both, path[0])
        try:
            postures = follow(path, hold, both)
        except InputError as error:
            refusal = refusal or str(error)
            continue
        touched = _touched(held, pipe, path, postures)
        if touched:
            refusal = refusal or touched
            continue
        try:
            approach = _approach(start, (right, left), pipe, generator, on_step)
        except InputError as error:
            refusal = refusal or str(error)
            continue
        return CarryPlan(pipe, move, approach, both, hold, postures)
    raise InputError(f"no pair of grasps can move the pipe so: {refusal}")


def _pairs(right: list[ToolPath], left: list[ToolPath]) -> Iterator[tuple[ToolPath, ToolPath]]:
    """Best ways of both before worse ones."""
    order = sorted(itertools.product(range(len(right)), range(len(left))), key=lambda each: (sum(each), each))
    return ((right[i], left[j]) for i, j in order)


def _touched(world: CollisionWorld, pipe: Pipe, path: Array, postures: Array) -> str:
    """What the arms would touch along the pipe's path; empty if nothing. What is in the way of the pipe is not seen."""
    for index, (pose, posture) in enumerate(zip(path, postures, strict=True)):
        turn = pose[:3, :3] @ path[0][:3, :3].T
        world.put(pipe.moved(turn, pose[:3, 3] - turn @ pipe.point), ())
        if not world.free(posture):
            return f"after {100 * index / (len(path) - 1):.0f} % of the way {world.what_touches(posture)} would touch"
    return ""


def _approach(
    start: Array, ways: tuple[ToolPath, ToolPath], pipe: Pipe, generator: np.random.Generator, on_step: Any
) -> Array:
    """One arm after the other: to before the pipe, then straight onto it, with open grippers."""
    opened = start
    for side in SIDES:
        opened = with_jaw(opened, side, math.radians(workcell_entries()["grasp"]["open_deg"]))
    rows, on_it = [start, opened], CollisionWorld(pipe, holding=SIDES)
    for way, holding in zip(ways, ((), ("right",)), strict=True):
        on_step(f"approach, {way.side} arm")
        before = with_arm(rows[-1], way.side, way.angles[0])
        rows += list(plan_path(CollisionWorld(pipe, holding=holding), rows[-1], before, generator))[1:]
        onto = [with_arm(rows[-1], way.side, row) for row in way.angles[1:]]
        stuck = next((each for each in onto if not on_it.free(each)), None)
        if stuck is not None:
            raise InputError(
                f"{on_it.what_touches(stuck)} would touch on the {way.side} arm's way onto the pipe"
            )
        rows += onto
    return np.array(rows)
