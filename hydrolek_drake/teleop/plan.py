"""Grasp and cut as a sequence of timed paths: approach, grasp, close, cut start, cut, retreat (thesis 5.2.5, 5.2.6)."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.steps import CLOSING, TaskPlan, joints_of, timed_step, without_doubles
from hydrolek_drake.vision.camera import CameraModel, camera_pose, direction_to_frame, to_frame
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.targets import PipeTargets
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import ToolPath, cut_path, grasp_paths, with_arm, with_jaw
from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries
from hydrolek_drake.workcell.planner import plan_path
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.surroundings import Block, Surroundings

Array = NDArray[np.float64]

STEPS = ("approach", "grasp", CLOSING, "cut start", "cut", "retreat")


def plan_task(
    targets: PipeTargets,
    camera: CameraModel,
    posture: ArrayLike,
    generator: np.random.Generator,
    *,
    grasping: str = "right",
    on_step: Any = lambda name: None,
) -> TaskPlan:
    """Plan grasp and cut from what the camera saw.

    Args:
        targets: In the camera frame.
        camera: The camera that saw them.
        posture: Both arms as they stand, in rad, shape (14,).
        generator: For the path planner.
        grasping: Arm that grasps, `right` or `left`; the other one cuts.
        on_step: Called with each step's name before it is planned.

    Raises:
        InputError: A point out of reach, nothing but collisions, no path; says which step and why.
    """
    return plan_grasp_and_cut(
        TaskWorlds(pipe_in_world(targets, camera), grasping),
        to_frame(targets.grasp, "world"),
        to_frame(targets.cut, "world"),
        direction_to_frame(targets.grasp, "world"),
        posture,
        generator,
        on_step=on_step,
    )


class TaskWorlds:
    """What says what touches in the steps of a task, with the machine at one height.

    Args:
        pipe: To be grasped and cut.
        grasping: Arm that grasps.
        around: What else stands around the machine, or None.

    Attributes:
        pipe: As given.
        grasping: As given.
        clear: Nothing may touch.
        touching: On the way onto the pipe, which is as much thinner as the gripper may come near it.
        held: The grasping gripper may touch the pipe.
    """

    def __init__(self, pipe: Pipe, grasping: str, around: Surroundings | None = None) -> None:
        other_side(grasping)  # is there such an arm?
        self.pipe, self.grasping = pipe, grasping
        self.clear = CollisionWorld(pipe, around=around)
        self.touching = CollisionWorld(thinner(pipe), padding=0.0, around=around)
        self.held = CollisionWorld(pipe, holding=(grasping,), around=around)

    def put(self, pipe: Pipe, blocks: tuple[Block, ...]) -> None:
        """Put pipe and blocks elsewhere; see `CollisionWorld.put`."""
        self.pipe = pipe
        self.clear.put(pipe, blocks)
        self.touching.put(thinner(pipe), blocks)
        self.held.put(pipe, blocks)


@dataclass(frozen=True)
class ToolPaths:
    """How a pipe is grasped and cut, without the ways there.

    Attributes:
        grasp: The grasping arm's way onto the pipe.
        cut: The cutting arm's way across it.
        closed: Both arms with the gripper on the pipe, in rad, shape (14,).
    """

    grasp: ToolPath
    cut: ToolPath
    closed: Array


def tool_paths(
    worlds: TaskWorlds,
    grasp_point: ArrayLike,
    cut_point: ArrayLike,
    sight: ArrayLike,
    posture: ArrayLike,
    *,
    on_step: Any = lambda name: None,
) -> ToolPaths:
    """Ways of the tools onto and across a pipe; see `plan_grasp_and_cut`.

    Raises:
        InputError: A point out of reach, or nothing but collisions; says why.
    """
    grasping, pipe = worlds.grasping, worlds.pipe
    cutting, start = other_side(grasping), np.asarray(posture, dtype=float)
    values, sizes = workcell_entries()["grasp"], kinect_entries("targets")
    on_step("grasp")
    distance = pipe.radius + sizes["approach"] + values["farther"]
    clear, touching, held = worlds.clear, worlds.touching, worlds.held
    grasp = next(grasp_paths(grasp_point, pipe.axis, sight, distance, start, grasping, clear, touching))
    on_pipe = with_arm(start, grasping, grasp.angles[-1])
    closed = with_jaw(on_pipe, grasping, math.radians(values["closed_deg"]))
    on_step("cut")
    reach = pipe.radius + sizes["clearance"]
    cut = cut_path(cut_point, pipe.axis, sight, reach, sizes["blade_reach"], closed, cutting, held)
    return ToolPaths(grasp, cut, closed)


def plan_grasp_and_cut(
    worlds: TaskWorlds,
    grasp_point: ArrayLike,
    cut_point: ArrayLike,
    sight: ArrayLike,
    posture: ArrayLike,
    generator: np.random.Generator,
    *,
    on_step: Any = lambda name: None,
) -> TaskPlan:
    """Plan grasp and cut of a pipe whose place is known.

    Args:
        worlds: The pipe, which arm grasps it, and what stands around; world frame as all points.
        grasp_point: On its axis, in m, shape (3,).
        cut_point: Likewise.
        sight: From the camera to the grasp, shape (3,).
        posture: Both arms as they stand, in rad, shape (14,).
        generator: For the path planner.
        on_step: Called with each step's name before it is planned.

    Raises:
        InputError: A point out of reach, nothing but collisions, no path; says which step and why.
    """
    start, grasping, cutting = np.asarray(posture, dtype=float), worlds.grasping, other_side(worlds.grasping)
    values = workcell_entries()["grasp"]
    ways = tool_paths(worlds, grasp_point, cut_point, sight, start, on_step=on_step)
    grasp, cut, closed, clear, held = ways.grasp, ways.cut, ways.closed, worlds.clear, worlds.held
    opened = with_jaw(start, grasping, math.radians(values["open_deg"]))
    before, on_pipe = (with_arm(opened, grasping, grasp.angles[i]) for i in (0, -1))
    shut = with_jaw(closed, cutting, math.radians(values["closed_deg"]))
    cut_postures = [with_arm(shut, cutting, row) for row in cut.angles]
    on_step("approach")
    approach = plan_path(clear, start, before, generator)
    on_step("cut start")
    to_cut = plan_path(held, closed, cut_postures[0], generator)
    on_step("retreat")
    home = np.array(closed)
    home[joints_of(cutting)] = home_posture()[joints_of(cutting)]
    retreat = plan_path(held, cut_postures[-1], home, generator)
    paths = {
        "approach": approach,
        "grasp": without_doubles(np.array([with_arm(opened, grasping, row) for row in grasp.angles])),
        CLOSING: np.array([on_pipe, closed]),
        "cut start": to_cut,
        "cut": without_doubles(np.array(cut_postures)),
        "retreat": retreat,
    }
    feed = float(np.linalg.norm(cut.points[-1] - cut.points[0])) / teleop_entries("task")["cut_speed"]
    steps = [
        timed_step(
            name,
            paths[name],
            None if STEPS.index(name) < STEPS.index(CLOSING) else grasping,
            line=name in ("grasp", "cut"),
            least=feed if name == "cut" else 0.0,
        )
        for name in STEPS
    ]
    return TaskPlan(tuple(steps), worlds.pipe, grasp, cut)


def other_side(side: str) -> str:
    """The other arm.

    Raises:
        InputError: There is no such arm.
    """
    if side not in SIDES:
        raise InputError(f"arm '{side}' is unknown; choose from {', '.join(SIDES)}")
    return SIDES[1 - SIDES.index(side)]


def pipe_in_world(targets: PipeTargets, camera: CameraModel) -> Pipe:
    """The fitted cylinder in the world frame, as long as it was seen, and longer where it leaves the picture."""
    cylinder, values = targets.cylinder, teleop_entries("task")
    reach = []
    for sign in (-1.0, 1.0):
        u, v = camera.pixel(cylinder.point + sign * cylinder.half_length * cylinder.axis)
        inside = min(u, v, camera.width - 1 - u, camera.height - 1 - v)
        reach.append(cylinder.half_length + (values["unseen"] if inside < values["border"] else 0.0))
    middle = cylinder.point + 0.5 * (reach[1] - reach[0]) * cylinder.axis
    axis = direction_to_frame(cylinder.axis, "world")
    return make_pipe(to_frame(middle, "world"), axis, cylinder.radius, sum(reach))


def thinner(pipe: Pipe) -> Pipe:
    """The pipe as the open gripper may come near it on its way onto it."""
    return make_pipe(pipe.point, pipe.axis, pipe.radius - workcell_entries()["grasp"]["give"], pipe.length)


def camera_in_world() -> Array:
    """Where the camera is, world frame, in m, shape (3,)."""
    return in_frame(camera_pose()[:3, 3], given_in="plate", wanted_in="world")
