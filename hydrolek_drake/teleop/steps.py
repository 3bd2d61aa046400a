"""Steps of a task: paths in time, what is watched at their ends, and a plan as a sequence of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.workcell.grasp import ToolPath
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.trajectory import smooth_trajectory, time_parametrised

Array = NDArray[np.float64]

CLOSING, OPENING = "close", "open"
"""Names of the steps in which a gripper closes on the pipe, and opens."""


@dataclass(frozen=True)
class Step:
    """One step of a task.

    Attributes:
        name: One of `plan.STEPS`, `place_plan.PLACE_STEPS`, or of the steps in `release`.
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
        *arm, jaw = range(14)[joints_of(gripping)]
        grips[arm] = True
        watched[jaw] = False
        watched[arm] = name != CLOSING
    return Step(name, trajectory, trajectory.end_time() + teleop_entries("task")["patience"], watched, grips)


def joints_of(side: str) -> slice:
    """Where an arm's seven joints are in a posture of both arms."""
    return slice(0, 7) if side == "right" else slice(7, 14)


def without_doubles(path: Array) -> Array:
    """A path without postures that repeat the one before."""
    kept = [path[0]]
    for posture in path[1:]:
        if np.max(np.abs(posture - kept[-1])) > 1e-6:
            kept.append(posture)
    return np.array(kept)
