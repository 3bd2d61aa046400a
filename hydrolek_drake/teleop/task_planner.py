"""From what was clicked, or from a task that is over, to the motion of the arms as they stand then."""

from collections.abc import Callable

import numpy as np

from hydrolek_drake.teleop.hand import within_limits
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.place_plan import plan_place_by_either
from hydrolek_drake.teleop.plan import plan_task
from hydrolek_drake.teleop.release import plan_letting_go
from hydrolek_drake.teleop.steps import TaskPlan
from hydrolek_drake.teleop.target_selection.clicks import Clicks


class TaskPlanner:
    """Plans for one machine, from the posture that it has when it is asked.

    Args:
        machine: Whose posture it is.
        seed: Of the path planner.
    """

    def __init__(self, machine: Machine, *, seed: int) -> None:
        self._machine = machine
        self._generator = np.random.default_rng(seed)

    def of_clicks(self, clicks: Clicks, on_step: Callable[[str], None]) -> TaskPlan:
        """Grasp and cut, or grasp and place.

        Args:
            clicks: All that the task needs.
            on_step: Told the name of each step before it is planned.

        Raises:
            InputError: No path leads there.
        """
        assert clicks.targets is not None  # all has been clicked
        targets, camera, posture = clicks.targets, clicks.frame.camera, self._posture()
        if clicks.place is None:
            return plan_task(targets, camera, posture, self._generator, on_step=on_step)
        return plan_place_by_either(targets, clicks.place, camera, posture, self._generator, on_step=on_step)

    def letting_go(self, plan: TaskPlan, step: str) -> TaskPlan:
        """The way home; see `plan_letting_go`.

        Args:
            plan: What was carried out, wholly or in part.
            step: In which it was aborted; empty at its end.

        Raises:
            InputError: The arms stand where no path leads home from.
        """
        return plan_letting_go(plan, step, self._posture(), self._generator)

    def _posture(self) -> np.ndarray:
        return within_limits(self._machine.state().position)
