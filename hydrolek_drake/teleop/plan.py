"""The task as a sequence of timed paths: approach, grasp, close, cut start, cut, retreat (thesis 5.2.5, 5.2.6)."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.vision.camera import CameraModel, camera_pose, direction_to_frame, to_frame
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.targets import PipeTargets
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import ToolPath, cut_path, grasp_paths, with_arm, with_jaw
from hydrolek_drake.workcell.pipe import Pipe, make_pipe, workcell_entries
from hydrolek_drake.workcell.planner import plan_path
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.surroundings import Block, Surroundings
from hydrolek_drake.workcell.trajectory import smooth_trajectory, time_parametrised

Array = NDArray[np.float64]

CLOSING = "close"
STEPS = ("approach", "grasp", CLOSING, "cut start", "cut", "retreat")
OPENING = "open"
RELEASE_STEPS = ("cutter home", OPENING, "back off", "home")

_ON_THE_WAY = math.radians(5.0)  # of a posture that belongs to the way onto the pipe


@dataclass(frozen=True)
class Step:
    """One step of a task.

    Attributes:
        name: One of `STEPS`, of `RELEASE_STEPS`, or of `place_plan.PLACE_STEPS`.
        trajectory: Joints `right_j1` ... `left_j7` over time from 0, in rad; a PiecewisePolynomial of 14 rows.
        timed_out_after: Seconds after which the step counts as failed.
        watched: Which joints must be within the tolerance at its end, shape (14,); a gripper that closes on a
            pipe cannot reach its set point, and draws its arm towards the pipe.
        gripping: Joints of the arm whose gripper is closed on the pipe, shape (14,). Closing it draws the arm until
            all fingers press; from the next step on the set points of these joints are moved by as much.
    """

    name: str
    trajectory: Any
    timed_out_after: float
    watched: NDArray[np.bool_]
    gripping: NDArray[np.bool_]


@dataclass(frozen=True)
class TaskPlan:
    """A planned task.

    Attributes:
        steps: In order.
        pipe: The pipe that was planned with, world frame.
        grasp: The grasping arm's way onto the pipe.
        cut: The cutting arm's way across it; None where nothing is cut.
        holds: Whether the pipe is in the gripper when all is done.
    """

    steps: tuple[Step, ...]
    pipe: Pipe
    grasp: ToolPath
    cut: ToolPath | None
    holds: bool = True

    @property
    def step_names(self) -> tuple[str, ...]:
        """Names of the steps in order."""
        return tuple(step.name for step in self.steps)

    def duration(self) -> float:
        """Planned time of all steps in s."""
        return float(sum(step.trajectory.end_time() for step in self.steps))


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
    home[_of(cutting)] = home_posture()[_of(cutting)]
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


def plan_release(plan: TaskPlan, posture: ArrayLike, generator: np.random.Generator) -> TaskPlan:
    """After a task, or an aborted one: cutter home, gripper open, straight back off the pipe, both arms home.

    Args:
        plan: The task that was carried out, wholly or in part.
        posture: Both arms as they stand, in rad, shape (14,).
        generator: For the path planner.

    Raises:
        InputError: The arms stand where no path leads home from.
    """
    start, home = np.asarray(posture, dtype=float), home_posture()
    grasping, cutting = _of(plan.grasp.side), _of("left" if plan.grasp.side == "right" else "right")
    clear, held = CollisionWorld(plan.pipe), CollisionWorld(plan.pipe, holding=(plan.grasp.side,))
    away = np.array(start)
    away[cutting] = home[cutting]
    paths = {"cutter home": plan_path(held, start, away, generator)}
    open_angle = math.radians(workcell_entries()["grasp"]["open_deg"])
    opened = with_jaw(away, plan.grasp.side, open_angle)
    paths[OPENING] = np.array([away, opened])
    far = np.max(np.abs(plan.grasp.angles - opened[grasping][:6]), axis=1)
    back = [opened]
    if far.min() < _ON_THE_WAY:
        back += [
            with_arm(opened, plan.grasp.side, row) for row in plan.grasp.angles[: far.argmin() + 1][::-1]
        ]
    paths["back off"] = without_doubles(np.array(back))
    paths["home"] = plan_path(clear, paths["back off"][-1], home, generator)
    steps = tuple(timed_step(name, paths[name], None, line=name == "back off") for name in RELEASE_STEPS)
    return TaskPlan(steps, plan.pipe, plan.grasp, plan.cut, holds=False)


def timed_step(name: str, path: Array, gripping: str | None, *, line: bool, least: float = 0.0) -> Step:
    """A path in time.

    Args:
        name: Of the step.
        path: Postures in rad, shape (n, 14).
        gripping: Side whose gripper closes on the pipe or is closed on it; None for none.
        line: Whether it is a straight path of the tool, which becomes one spline; else it rests at each posture.
        least: Seconds it takes at least.
    """
    trajectory = smooth_trajectory(path) if line else time_parametrised(path)
    if trajectory.end_time() < least:
        trajectory.ScaleTime(least / trajectory.end_time())
    watched, grips = np.ones(14, bool), np.zeros(14, bool)
    if gripping is not None:
        *arm, jaw = range(14)[_of(gripping)]
        grips[arm] = True
        watched[jaw] = False
        watched[arm] = name != CLOSING
    return Step(name, trajectory, trajectory.end_time() + teleop_entries("task")["patience"], watched, grips)


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


def _of(side: str) -> slice:
    return slice(0, 7) if side == "right" else slice(7, 14)


def without_doubles(path: Array) -> Array:
    """A path without postures that repeat the one before."""
    kept = [path[0]]
    for posture in path[1:]:
        if np.max(np.abs(posture - kept[-1])) > 1e-6:
            kept.append(posture)
    return np.array(kept)
