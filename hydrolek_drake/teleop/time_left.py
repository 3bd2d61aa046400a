"""How much of a task is done, and how long the rest takes at the pace at which the plant really runs."""

import math
import time
from collections.abc import Callable

from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.machine_state import MachineState
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.teleop.steps import TaskPlan


class TimeLeft:
    """Follows one task.

    Every step takes as long as its trajectory and then settles; the pace is planned time done over time that passed
    while the task ran, forgotten exponentially. A simulated plant on a busy computer is slower than real time, and
    joints that lag settle late: both are in the pace.

    Args:
        plan: of the task.
        clock: seconds that pass.
    """

    def __init__(self, plan: TaskPlan, clock: Callable[[], float] = time.monotonic) -> None:
        settled, self._memory = (
            teleop_entries("task")["settled"],
            teleop_entries("console")["pace_memory"],
        )
        self._durations = [step.trajectory.end_time() + settled for step in plan.steps]
        self._clock = clock
        self._last: tuple[float, float] | None = None
        self._done, self._passed = 0.0, 0.0

    def told(self, state: MachineState) -> tuple[float, float | None]:
        """Share of the planned time that is done, and seconds that are left; None as long as no pace is known.

        Args:
            state: of the machine while it moves.
        """
        whole = sum(self._durations)
        if state.mode is Mode.DONE:
            return 1.0, 0.0
        number = min(state.step_number, len(self._durations) - 1)
        done = sum(self._durations[:number]) + min(state.time_in_step, self._durations[number])
        now = self._clock()
        if state.mode is not Mode.RUNNING:
            self._last = None  # time that passes while it stands still says nothing of its pace
        else:
            if self._last is not None:
                before, planned = self._last
                passed = now - before
                keep = math.exp(-passed / self._memory)
                self._done = keep * self._done + max(done - planned, 0.0)
                self._passed = keep * self._passed + passed
            self._last = (now, done)
        pace = self._done / self._passed if self._passed > 0.0 else 0.0
        return done / whole, (whole - done) / pace if pace > 0.0 else None
