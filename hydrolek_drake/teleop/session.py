"""What the operator does, without any browser: four clicks, confirmation, stop (thesis 5.2, stages 2 to 6)."""

import threading
from collections.abc import Callable
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.camera_thread import CameraThread
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.machine_state import MachineState
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.teleop.sequencer import Mode, Order
from hydrolek_drake.teleop.stages import STAGE_FOR, STEPS_OF, Stage
from hydrolek_drake.teleop.steps import TaskPlan
from hydrolek_drake.teleop.target_selection.clicks import Task
from hydrolek_drake.teleop.target_selection.pictures import Pictures
from hydrolek_drake.teleop.target_selection.target_selection import TargetSelection, task_named
from hydrolek_drake.teleop.task_planner import TaskPlanner
from hydrolek_drake.teleop.undertaking import Undertaking
from hydrolek_drake.vision.edges import EdgeSettings
from hydrolek_drake.vision.frames import FrameSource


class OperatorSession:
    """One operator's work at one machine. Calls may come from any thread.

    Args:
        source: Makes the frame source; it is called, and the source read, in one thread of its own, as the
            renderer needs it.
        machine: What moves.
        seed: Of the path planner.
        stand: Tells a simulated camera where the joints and a loose pipe are before each frame, if given.
    """

    def __init__(
        self,
        source: Callable[[], FrameSource],
        machine: Machine,
        *,
        seed: int,
        stand: Callable[[FrameSource, MachineState], None] | None = None,
    ) -> None:
        self._machine = machine

        def arms_as_they_stand(frames: FrameSource) -> None:
            if stand is not None:
                stand(frames, machine.state())

        self._camera = CameraThread(source, arms_as_they_stand)
        self._planner = TaskPlanner(machine, seed=seed)
        self._lock = threading.RLock()
        self._stage = Stage.LIVE
        self._message, self._error = "", ""
        self._pictures = Pictures()
        self._selection = TargetSelection(self._pictures)
        self._camera_lost = ""
        self._undertaking = Undertaking(machine, self._lock)
        self._steps: tuple[str, ...] = STEPS

    def close(self) -> None:
        """End the threads; the machine is closed by its owner."""
        self._camera.close()
        self._undertaking.close()

    def refresh(self) -> None:
        """Read a live frame for the colour picture. A lost camera is shown, not raised, and stops the arms once.

        Who resumes then does it without a picture.
        """
        try:
            frame = self._camera.read()
        except InputError as error:
            if not self._camera_lost:
                self._camera_lost = f"{error}. The arms are stopped."
                self.order(Order.STOP)
            with self._lock:
                self._error = self._camera_lost
            return
        with self._lock:
            if self._camera_lost and self._error == self._camera_lost:
                self._error = ""
            self._camera_lost = ""
            self._pictures.show("live", frame.colour)

    def snapshot(self) -> None:
        """Stage 2: take a frame and process it. Discards what was clicked before.

        Raises:
            InputError: The camera gives none, or the arms are moving.
        """
        self._not_while_moving()
        frame = self._camera.read()
        with self._lock:
            self._selection.begin(frame)
            self._stage, self._message = Stage.OBJECT, ""

    def set_task(self, name: str) -> None:
        """What is to be done: cut, or place. Of what was clicked, the last point is forgotten.

        Raises:
            InputError: Unknown name, or the arms are moving.
        """
        task = task_named(name)
        self._not_while_moving()
        with self._lock:
            self._steps = STEPS_OF[task]
            self._selection.change_task(task)
            self._ask()

    def set_sliders(self, **values: float) -> None:
        """Stage 3: low_contrast, high_contrast, sensitivity between 0 and 1; the edge picture follows.

        Raises:
            InputError: Unknown name or a value out of range; nothing changes then.
        """
        with self._lock:
            self._selection.set_sliders(values, follow=self._stage not in (Stage.PLANNING, Stage.MOVING))

    def set_fill(self, name: str) -> None:
        """What a click on the object is filled up to: surfaces or edges.

        Raises:
            InputError: Unknown name.
        """
        with self._lock:
            self._selection.set_fill(name)

    def click(self, u: float, v: float) -> None:
        """Stages 4 and 5: the object, then the grasp, then the cut or the place.

        Raises:
            InputError: What is wrong with the click; the stage stays, the arms stand still.
        """
        with self._lock:
            if self._selection.clicks is not None and self._stage in (Stage.PLANNING, Stage.MOVING):
                raise InputError("no click is needed now; confirm, or go back")
            self._selection.click(u, v)
            self._ask()

    def back(self) -> None:
        """Take the last click back; before the first, go back to the live picture.

        Raises:
            InputError: The arms are moving.
        """
        self._not_while_moving()
        with self._lock:
            self._selection.back()
            self._stage, self._message = Stage.LIVE, ""
            self._ask()

    def confirm(self) -> None:
        """Stage 6: plan, and move if a plan is found.

        Raises:
            InputError: Not everything has been clicked.
        """
        with self._lock:
            if self._stage is not Stage.CONFIRM:
                last = "cut" if self._selection.task is Task.CUT else "place"
                raise InputError(f"object, grasp and {last} must be clicked before you confirm")
            clicks = self._selection.clicks
            assert clicks is not None  # the stage says so
            self._begin(lambda: self._planner.of_clicks(clicks, self._tell_step), Stage.CONFIRM)

    def release(self) -> None:
        """After a task: open the gripper, back off, both arms to the posture that a task starts from.

        Raises:
            InputError: No task has been carried out, or one is going on.
        """
        self._not_while_moving()
        with self._lock:
            held = self._undertaking.held
            if held is None:
                raise InputError("nothing is held; a task must have been started before")
            self._selection.forget()
            self._begin(lambda: self._planner.letting_go(*held), Stage.LIVE)
            self._selection.draw()

    def halt(self) -> None:
        """Stop the arms and keep a task that is planned from starting; waits for no picture, click or plan."""
        self._undertaking.withdraw()
        self._machine.order(Order.STOP)

    def order(self, order: Order) -> None:
        """Stop, resume or abort; a stop while a task is planned keeps it from starting."""
        if order is Order.STOP:
            self.halt()
        with self._lock:  # a task that was just starting has started now: it is stopped below
            if self._stage is Stage.PLANNING and order is not Order.RESUME:
                self._undertaking.withdraw()
                self._stage = Stage.LIVE if self._selection.clicks is None else Stage.CONFIRM
                self._message = "Stopped before the arms moved."
        self._machine.order(order)

    def move_by_hand(self, *, deflection: Any = None, towards_deg: Any = None) -> None:
        """Move joints by joystick or to the sliders' angles; must be repeated, see `Machine.move_by_hand`.

        Args:
            deflection: 14 numbers in percent.
            towards_deg: 14 angles in degrees, instead.

        Raises:
            InputError: A task is planned or under way, or the numbers are wrong.
        """
        self._not_while_moving()
        if towards_deg is not None:
            self._machine.move_by_hand(towards=np.radians(towards_deg))
        else:
            self._machine.move_by_hand(deflection=np.asarray(deflection, dtype=float))

    def let_go(self) -> None:
        """Joystick and sliders are let go."""
        self._machine.let_go()

    def lose_operator(self) -> None:
        """The browser in control is gone: nothing is held any more, and a task stops; who takes over may resume."""
        self._machine.let_go()
        self._undertaking.withdraw()
        if self._stage in (Stage.PLANNING, Stage.MOVING):  # without the lock, which a click may hold for long
            self.order(Order.STOP)

    def state(self) -> dict[str, Any]:
        """All that the console shows, as plain values."""
        machine = self._machine.state()
        with self._lock:
            self._after_moving(machine)
            clicks = self._selection.clicks
            return {
                "stage": self._stage.name.lower(),
                "instruction": self._stage.value,
                "message": self._message,
                "unsure": self._stage is Stage.GRASP and clicks is not None and clicks.unsure(),
                "error": self._error or machine.reason,
                **self._selection.shown(),
                "version": self._pictures.version,
                "steps": list(self._steps),
                "can_release": self._undertaking.held is not None
                and self._stage not in (Stage.PLANNING, Stage.MOVING)
                and machine.mode in (Mode.DONE, Mode.ABORTED),
                **self._undertaking.shown(machine if self._stage is Stage.MOVING else None),
                **machine.shown(),
            }

    def picture(self, name: str) -> bytes:
        """`colour` or `edges` as JPEG, empty where there is none yet."""
        with self._lock:
            clicking = self._selection.clicks is not None and self._stage is not Stage.MOVING
            return self._pictures.jpeg("live" if name == "colour" and not clicking else name)

    def _ask(self) -> None:
        """Go to the stage of the click that is wanted next, if any is."""
        if (clicks := self._selection.clicks) is not None:
            self._stage, self._message = STAGE_FOR[clicks.wanted()], clicks.told()

    def _begin(self, make: Callable[[], TaskPlan], otherwise: Stage) -> None:
        """Undertake what is planned so; the stage if there is no plan."""

        def started(plan: TaskPlan) -> None:
            self._steps = plan.step_names
            self._stage, self._message = Stage.MOVING, f"Planned for {plan.duration():.1f} s."
            self._pictures.changed()

        def failed(reason: Exception) -> None:
            if isinstance(reason, InputError):
                self._stage, self._error, self._message = otherwise, str(reason), ""
            else:
                self._stage = Stage.LIVE
                self._selection.forget()
                self._error = f"the motion could not be planned: {reason}"

        self._stage, self._error = Stage.PLANNING, ""
        self._undertaking.begin(make, started=started, failed=failed)

    def _tell_step(self, name: str) -> None:
        with self._lock:
            self._message = f"Planning: {name}."

    def _after_moving(self, machine: MachineState) -> None:
        if self._stage is not Stage.MOVING:
            return
        ended = self._undertaking.ended(machine)
        if ended is None:
            return
        word = "Done" if ended.mode is Mode.DONE else "Aborted"
        self._message = f"{word} after {self._undertaking.seconds():.1f} s."
        self._stage = Stage.LIVE
        self._selection.forget()
        self._selection.draw()

    def _not_while_moving(self) -> None:
        with self._lock:
            if self._stage in (Stage.PLANNING, Stage.MOVING):
                raise InputError("the arms are moving; abort the task before you begin another")

    def settings(self) -> EdgeSettings:
        """The sliders as they stand."""
        return self._selection.settings
