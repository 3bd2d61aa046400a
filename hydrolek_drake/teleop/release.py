"""After a task, or an aborted one: what holds or surrounds the pipe lets go of it, and both arms go home."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.place_plan import HOLDING_STEPS, PLACE_STEPS, PlacePlan
from hydrolek_drake.teleop.steps import OPENING, TaskPlan, joints_of, timed_step, without_doubles
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import straight_path, tool_in_world, with_arm, with_jaw
from hydrolek_drake.workcell.pipe import Pipe, workcell_entries
from hydrolek_drake.workcell.planner import plan_path
from hydrolek_drake.workcell.scene import home_posture

Array = NDArray[np.float64]

RELEASE_STEPS = ("cutter home", OPENING, "back off", "home")
LET_GO_STEPS = (OPENING, "back off", "home")

_ON_THE_WAY = math.radians(5.0)  # of a posture that belongs to the way onto the pipe


def plan_letting_go(
    plan: TaskPlan, step: str, posture: ArrayLike, generator: np.random.Generator
) -> TaskPlan:
    """The way home after a plan that ended or was aborted.

    Args:
        plan: What was carried out, wholly or in part.
        step: In which it was aborted; empty at its end.
        posture: Both arms as they stand, in rad, shape (14,).
        generator: For the path planner.

    Raises:
        InputError: The arms stand where no path leads home from.
    """
    if not isinstance(plan, PlacePlan):
        return plan_release(plan, posture, generator)
    start, side = np.asarray(posture, dtype=float), plan.grasp.side
    pipe = pipe_after(plan, step, start)
    clear = CollisionWorld(pipe, table=plan.table)
    opened = with_jaw(start, side, math.radians(workcell_entries()["grasp"]["open_deg"]))
    back = [opened]
    if not clear.free(opened):
        turned, here = tool_in_world(opened, side)
        before, _ = tool_in_world(with_arm(opened, side, plan.grasp.angles[-1]), side)
        turn = turned @ before.T
        away = here + turn @ (plan.grasp.points[0] - plan.grasp.points[-1])
        angles = straight_path(side, here, away, turn @ plan.grasp.direction, pipe.axis, _arm(opened, side))
        if angles is None:
            raise InputError(f"the {side} arm cannot back off the pipe from where it stands; move it by hand")
        back += [with_arm(opened, side, row) for row in angles]
    paths = {
        OPENING: np.array([start, opened]),
        "back off": without_doubles(np.array(back)),
        "home": plan_path(clear, back[-1], home_posture(), generator),
    }
    steps = tuple(timed_step(name, paths[name], None, line=name == "back off") for name in LET_GO_STEPS)
    return TaskPlan(steps, pipe, plan.grasp, None, holds=False)


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
    grasping, cutting = (
        joints_of(plan.grasp.side),
        joints_of("left" if plan.grasp.side == "right" else "right"),
    )
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


def pipe_after(plan: PlacePlan, step: str, posture: Array) -> Pipe:
    """Where the pipe is after an abort in a step: where it stood, in the hand, or at its place."""
    if step in HOLDING_STEPS:
        side = plan.grasp.side
        turned, here = tool_in_world(posture, side)
        before, there = tool_in_world(with_arm(posture, side, plan.grasp.angles[-1]), side)
        turn = turned @ before.T
        return plan.pipe.moved(turn, here - turn @ there)
    return plan.placed if step in ("", *PLACE_STEPS[PLACE_STEPS.index(OPENING) :]) else plan.pipe


def _arm(posture: Array, side: str) -> Array:
    begin = 0 if side == "right" else 7
    return np.array(posture[begin : begin + 6])
