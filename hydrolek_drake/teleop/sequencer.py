"""The task sequence as a Drake system: set points, tolerances, time-outs, stop, resume, abort."""

import math
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.common.value import Value
from pydrake.systems.framework import BasicVector, Context, EventStatus, LeafSystem, State

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.hand import travel
from hydrolek_drake.teleop.steps import CLOSING, Step, TaskPlan

Array = NDArray[np.float64]

_JOINTS = 14


class Mode(IntEnum):
    """What the sequencer does."""

    IDLE = 0
    RUNNING = 1
    STOPPED = 2
    TIMED_OUT = 3
    ABORTED = 4
    DONE = 5


class Order(IntEnum):
    """What the operator wants; each new number at `order` is acted on once."""

    NONE = 0
    STOP = 1
    RESUME = 2
    ABORT = 3


class TaskSequencer(LeafSystem):
    """Runs a `TaskPlan`: holds each step's trajectory against the measured joints, and goes on when they arrived.

    ```
                          +----------------+
    position_measured --->|                |---> position_desired
               order ---->|  TaskSequencer |---> valves_open
                          |                |---> progress
                          +----------------+
    ```

    Inputs: `position_measured`, joints `right_j1` ... `left_j7` in rad (14); `order`, a number of `Order` (1).
    Outputs: `position_desired` in rad (14); `valves_open`, 1 while the arms may move (1); `progress`: mode, step,
    time in the step in s, planned time of the step in s (4).

    A step ends when its trajectory has ended and every watched joint has been within the tolerance for the settling
    time. It fails when it takes longer than it may. An arm whose gripper has closed is held by the pipe: its set points
    are moved to where it then stands in the mean, for as long as the gripper is closed, so that the controllers do not
    press against the pipe. On a stop, a failure or an abort the set point becomes the
    measured position and the valves close; a resume continues the trajectory where it was stopped; an aborted task
    cannot be resumed. All of it is state of the Context; every output depends on that alone.
    """

    def __init__(self) -> None:
        super().__init__()
        self.set_name("task_sequencer")
        self._values = teleop_entries("task")
        self._travel = travel()
        self.position_measured_input = self.DeclareVectorInputPort("position_measured", _JOINTS)
        self.order_input = self.DeclareVectorInputPort("order", 1)
        self._plan = self.DeclareAbstractState(Value[object]())
        # mode, step, time in step, time on trajectory, time within tolerance, last order
        self._clock = self.DeclareDiscreteState(6)
        self._held = self.DeclareDiscreteState(_JOINTS)
        self._off = self.DeclareDiscreteState(_JOINTS)  # mean of readings less set points while all are near
        self._drawn = self.DeclareDiscreteState(
            _JOINTS
        )  # that of the gripping arm when its gripper had closed
        tickets = {self.all_state_ticket()}
        self.position_desired_output = self.DeclareVectorOutputPort(
            "position_desired", _JOINTS, self._calc_position, tickets
        )
        self.valves_open_output = self.DeclareVectorOutputPort("valves_open", 1, self._calc_valves, tickets)
        self.progress_output = self.DeclareVectorOutputPort("progress", 4, self._calc_progress, tickets)
        self.DeclarePeriodicUnrestrictedUpdateEvent(self._values["period"], 0.0, self._update)

    def start(self, context: Context, plan: TaskPlan, posture: Any) -> None:
        """Begin a task.

        Args:
            context: This system's context.
            plan: What to do.
            posture: Measured joints in rad, shape (14,).

        Raises:
            InputError: A task is running or stopped, or the arms do not stand where the plan begins.
        """
        mode = self.mode(context)
        if mode in (Mode.RUNNING, Mode.STOPPED, Mode.TIMED_OUT):
            raise InputError(
                f"a task is {mode.name.lower().replace('_', ' ')}; abort it before another starts"
            )
        first = plan.steps[0].trajectory.value(0.0)[:, 0]
        off = np.degrees(np.max(np.abs(np.asarray(posture) - first)))
        if off > self._values["displaced_deg"]:
            raise InputError(
                f"the arms have moved by {off:.1f} deg since the task was planned; plan it again from where they are"
            )
        context.SetAbstractState(self._plan, plan)
        order = context.get_discrete_state(self._clock).value()[5]
        context.SetDiscreteState(self._clock, [Mode.RUNNING, 0, 0, 0, 0, order])
        context.SetDiscreteState(self._held, posture)
        context.SetDiscreteState(self._drawn, np.zeros(_JOINTS))

    def mode(self, context: Context) -> Mode:
        """What the sequencer does now."""
        return Mode(int(context.get_discrete_state(self._clock).value()[0]))

    def one_update_on(self, context: Context) -> float:
        """Time in s to advance to so that exactly one more update is made, half a period after it.

        At the updates' own times rounding would sometimes leave one out and make two the next time.
        """
        period = self._values["period"]
        return float((math.floor(context.get_time() / period + 0.75) + 0.5) * period)

    def step_name(self, context: Context) -> str:
        """Name of the current step, empty where there is none."""
        plan = self._planned(context)
        if plan is None or self.mode(context) in (Mode.IDLE, Mode.DONE):
            return ""
        return plan.steps[int(context.get_discrete_state(self._clock).value()[1])].name

    def _planned(self, context: Context) -> TaskPlan | None:
        plan: Any = context.get_abstract_state(int(self._plan)).get_value()
        return plan if isinstance(plan, TaskPlan) else None

    def _update(self, context: Context, state: State) -> EventStatus:
        clock = np.array(context.get_discrete_state(self._clock).value())
        measured = self.position_measured_input.Eval(context)
        order = Order(int(self.order_input.Eval(context)[0]))
        mode = Mode(int(clock[0]))
        changed, clock[5] = order != Order(int(clock[5])), order
        if mode is Mode.IDLE:
            state.get_mutable_discrete_state(self._held).SetFromVector(measured)
        elif mode is Mode.DONE:
            if changed and order in (
                Order.STOP,
                Order.ABORT,
            ):  # it still holds what it grasped, with open valves
                mode = self._hold(state, measured, Mode.ABORTED)
        elif changed and order is Order.ABORT:
            mode = self._hold(state, measured, Mode.ABORTED)
        elif changed and order is Order.STOP and mode is Mode.RUNNING:
            mode = self._hold(state, measured, Mode.STOPPED)
        elif changed and order is Order.RESUME and mode in (Mode.STOPPED, Mode.TIMED_OUT):
            mode, clock[2] = Mode.RUNNING, clock[3]  # the time-out counts anew from here
        if mode is Mode.RUNNING:
            mode = self._advance(context, state, clock, measured)
        clock[0] = mode
        state.get_mutable_discrete_state(self._clock).SetFromVector(clock)
        return EventStatus.Succeeded()

    def _advance(self, context: Context, state: State, clock: Array, measured: Array) -> Mode:
        plan = self._planned(context)
        assert plan is not None  # a running task has one
        step, period = plan.steps[int(clock[1])], self._values["period"]
        clock[2] += period
        clock[3] = min(clock[3] + period, step.trajectory.end_time())
        drawn = np.array(context.get_discrete_state(self._drawn).value())
        desired = self._set_points(step, clock[3], drawn)
        near = np.abs(measured - desired)[step.watched].max() <= np.radians(self._values["tolerance_deg"])
        arrived = near and clock[3] >= step.trajectory.end_time()
        clock[4] = clock[4] + period if arrived else 0.0
        off = state.get_mutable_discrete_state(self._off)
        readings = max(round(clock[4] / period), 1)
        off.SetFromVector(off.value() + (measured - desired - off.value()) / readings)
        if clock[4] >= self._values["settled"]:
            if step.name == CLOSING:
                drawn = np.where(step.gripping, off.value(), 0.0)
                state.get_mutable_discrete_state(self._drawn).SetFromVector(drawn)
            if int(clock[1]) + 1 == len(plan.steps):
                state.get_mutable_discrete_state(self._held).SetFromVector(desired)
                return Mode.DONE
            clock[1:5] = (clock[1] + 1, 0.0, 0.0, 0.0)
        elif clock[2] > step.timed_out_after:
            return self._hold(state, measured, Mode.TIMED_OUT)
        return Mode.RUNNING

    def _set_points(self, step: Step, seconds: float, drawn: Array) -> Array:
        """Where the joints should be in a step, in rad, shape (14,)."""
        planned = step.trajectory.value(seconds)[:, 0]
        return np.where(step.gripping, np.clip(planned + drawn, *self._travel), planned)

    def _hold(self, state: State, measured: Array, mode: Mode) -> Mode:
        within = np.clip(measured, *self._travel)  # noise at a stop is no set point
        state.get_mutable_discrete_state(self._held).SetFromVector(within)
        return mode

    def _calc_position(self, context: Context, output: BasicVector) -> None:
        clock = context.get_discrete_state(self._clock).value()
        plan = self._planned(context)
        if plan is not None and int(clock[0]) == Mode.RUNNING:
            drawn = context.get_discrete_state(self._drawn).value()
            output.SetFromVector(self._set_points(plan.steps[int(clock[1])], clock[3], drawn))
        else:
            output.SetFromVector(context.get_discrete_state(self._held).value())

    def _calc_valves(self, context: Context, output: BasicVector) -> None:
        output[0] = float(self.mode(context) in (Mode.RUNNING, Mode.DONE))

    def _calc_progress(self, context: Context, output: BasicVector) -> None:
        clock, plan = context.get_discrete_state(self._clock).value(), self._planned(context)
        planned = plan.steps[int(clock[1])].trajectory.end_time() if plan is not None else 0.0
        output.SetFromVector([clock[0], clock[1], clock[2], planned])
