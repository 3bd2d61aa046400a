"""A task from its confirmation to its end: planned in a thread of its own, carried out by the machine, timed."""

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from threading import RLock

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.machine_state import MachineState
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.teleop.stages import STEPS_OF
from hydrolek_drake.teleop.steps import TaskPlan
from hydrolek_drake.teleop.time_left import TimeLeft


class Undertaking:
    """What the arms are asked to do, one task after the other.

    Args:
        machine: What moves.
        lock: Held while the machine is started and while the outcome is told.

    Attributes:
        plan: Of the task that was started last.
        held: What is held after a task: its plan, and the step that it was aborted in, empty if it was done.
    """

    def __init__(self, machine: Machine, lock: RLock) -> None:
        self._machine, self._lock = machine, lock
        self._planner = ThreadPoolExecutor(1, thread_name_prefix="planner")
        self._asked: object = None  # the planning whose plan is still wanted
        self._began: float | None = None
        self._took: float | None = None
        self._left: TimeLeft | None = None
        self.plan: TaskPlan | None = None
        self.held: tuple[TaskPlan, str] | None = None

    def close(self) -> None:
        """End the planner's thread."""
        self._planner.shutdown(wait=True, cancel_futures=True)

    def begin(
        self,
        make: Callable[[], TaskPlan],
        *,
        started: Callable[[TaskPlan], None],
        failed: Callable[[Exception], None],
    ) -> None:
        """Plan, and move if a plan is found.

        Args:
            make: Plans; called in the planner's thread.
            started: Told the plan once the machine has taken it.
            failed: Told why there is none: an `InputError`, or what nobody foresaw.
        """
        self._began, self._took = time.monotonic(), None
        asked = self._asked = object()

        def plan_and_go() -> None:
            try:
                plan = make()
            except InputError as error:
                with self._lock:
                    if self._asked is asked:
                        failed(error)
                return
            with self._lock:
                if self._asked is not asked:
                    return  # withdrawn meanwhile
                try:
                    self._machine.start(plan)
                except InputError as error:
                    failed(error)
                    return
                self.plan, self._left = plan, TimeLeft(plan)
                started(plan)

        def after(planning: "Future[None]") -> None:
            unforeseen = None if planning.cancelled() else planning.exception()
            if isinstance(unforeseen, Exception):
                with self._lock:
                    if self._asked is asked:
                        failed(unforeseen)

        self._planner.submit(plan_and_go).add_done_callback(after)

    def withdraw(self) -> None:
        """What is being planned is not wanted any more."""
        self._asked = None

    def ended(self, state: MachineState) -> MachineState | None:
        """How the task ended, or None as long as it has not; what is held then is in `held`.

        Args:
            state: Of the machine; it may be from before the task began, so that it is only believed if the machine
                still says so.
        """
        if state.mode not in (Mode.DONE, Mode.ABORTED):
            return None
        state = self._machine.state()
        if state.mode not in (Mode.DONE, Mode.ABORTED):
            return None
        plan = self.plan
        assert plan is not None  # it moved
        self._took, self._began = self.seconds(), None
        if state.mode is Mode.DONE:
            self.held = (plan, "") if plan.holds else None
        elif (
            plan.step_names in STEPS_OF.values()
        ):  # an aborted release is begun again from the task before it
            self.held = (plan, state.step)
        return state

    def shown(self, moving: MachineState | None) -> dict[str, float | None]:
        """What the console shows of it: seconds so far, share that is done, seconds that are left; see `TimeLeft`.

        Args:
            moving: state of the machine while it moves, else None.
        """
        done, left = (0.0, None) if moving is None or self._left is None else self._left.told(moving)
        return {
            "seconds": self.seconds(),
            "done": round(done, 4),
            "left_s": None if left is None else round(left, 1),
        }

    def seconds(self) -> float | None:
        """Since the task was confirmed, until it ended."""
        return self._took if self._began is None else round(time.monotonic() - self._began, 1)
