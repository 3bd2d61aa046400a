"""The moving side of the console: sequencer, link and arms, each stepped in real time by a thread."""

import threading
import time
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.link import SetpointClient, SetpointServer
from hydrolek_drake.teleop.plan import TaskPlan
from hydrolek_drake.teleop.sequencer import Mode, Order, TaskSequencer
from hydrolek_drake.teleop.simulated_arms import SimulatedArms

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MachineState:
    """What the console shows.

    Attributes:
        mode: Of the sequencer.
        step: Name of the current step, empty where there is none.
        step_number: Its place, from 0.
        time_in_step: In s.
        planned: Planned time of the step in s.
        position: Measured joints in rad, shape (14,).
        desired: Set points in rad, shape (14,).
        valves_open: Whether the arms may move.
        reason: Why the valves are closed, or empty.
    """

    mode: Mode
    step: str
    step_number: int
    time_in_step: float
    planned: float
    position: Array
    desired: Array
    valves_open: bool
    reason: str


class ArmsEnd:
    """The controllers' end with simulated arms: a link server whose set points the arms follow.

    Args:
        posture: Joints at first, in rad, shape (14,).
        port: TCP port, 0 for any free one.
        host: Address to listen at.
    """

    def __init__(self, posture: Array, *, port: int | None = None, host: str = "127.0.0.1") -> None:
        self.server = SetpointServer(posture, port=port, host=host)
        self._period = teleop_entries("task")["period"]
        self._arms = SimulatedArms(posture, self._period)
        self._simulator = Simulator(self._arms)

    def advance(self) -> Array:
        """Let the arms follow for one period; returns the measured joints in rad, shape (14,)."""
        context = self._simulator.get_mutable_context()
        desired, valves_open, _ = self.server.command()
        self._arms.position_desired_input.FixValue(context, desired)
        self._arms.valves_open_input.FixValue(context, [float(valves_open)])
        self._simulator.AdvanceTo(context.get_time() + self._period)
        position = np.array(self._arms.position_measured_output.Eval(context))
        self.server.report(position)
        return position


class Machine:
    """Runs tasks: the sequencer here, the set points over the link, the arms at its other end.

    Args:
        posture: Joints at first, in rad, shape (14,).
        controllers: Host and port of the controllers' end; a simulated one on the loopback if not given.
        realtime_rate: Simulated seconds a second; tests run faster.
    """

    def __init__(
        self, posture: Array, *, controllers: tuple[str, int] | None = None, realtime_rate: float = 1.0
    ) -> None:
        self._arms = ArmsEnd(posture, port=0) if controllers is None else None
        host, port = controllers or ("127.0.0.1", self._arms.server.port if self._arms else 0)
        self._client: SetpointClient | None = SetpointClient(port, host)
        self._sequencer = TaskSequencer()
        self._simulator = Simulator(self._sequencer)
        self._period = teleop_entries("task")["period"] / realtime_rate
        self._step_period = teleop_entries("task")["period"]
        self._lock = threading.Lock()
        self._measured = self._client.stop() if controllers else np.array(posture, dtype=float)
        self._order, self._lost = Order.NONE, ""
        self._running = True
        self._thread = threading.Thread(target=self._run, name="machine", daemon=True)
        self._thread.start()

    def start(self, plan: TaskPlan) -> None:
        """Begin a task.

        Raises:
            InputError: One is running, the arms have moved since it was planned, or the link is lost.
        """
        with self._lock:
            if self._lost:
                raise InputError(self._lost)
            self._sequencer.start(self._simulator.get_mutable_context(), plan, self._measured)

    def order(self, order: Order) -> None:
        """Stop at once, resume, or abort."""
        with self._lock:
            if order is self._order:  # the same again: let the sequencer see a change
                self._tick(Order.NONE)
            self._order = order
            self._tick(order)

    def state(self) -> MachineState:
        """What the console shows now."""
        with self._lock:
            context = self._simulator.get_context()
            mode, number, seconds, planned = self._sequencer.progress_output.Eval(context)
            open_ = bool(self._sequencer.valves_open_output.Eval(context)[0]) and not self._lost
            return MachineState(
                Mode(int(mode)),
                self._sequencer.step_name(context),
                int(number),
                float(seconds),
                float(planned),
                self._measured.copy(),
                np.array(self._sequencer.position_desired_output.Eval(context)),
                open_,
                self._lost,
            )

    def close(self) -> None:
        """Close the valves and end the thread."""
        self._running = False
        self._thread.join(timeout=2.0)
        if self._client is not None:
            self._client.close()
        if self._arms is not None:
            self._arms.server.close()

    def _run(self) -> None:
        following = time.monotonic()
        while self._running:
            with self._lock:
                self._tick(self._order)
            following += self._period
            time.sleep(max(0.0, following - time.monotonic()))
            following = max(following, time.monotonic() - 1.0)  # after a pause, do not run to catch up

    def _tick(self, order: Order) -> None:
        """One period: measured joints into the sequencer, its set points over the link, the arms follow."""
        context: Any = self._simulator.get_mutable_context()
        self._sequencer.position_measured_input.FixValue(context, self._measured)
        lost = bool(self._lost) and self._sequencer.mode(context) is Mode.RUNNING
        self._sequencer.order_input.FixValue(context, [float(Order.STOP if lost else order)])
        self._simulator.AdvanceTo(context.get_time() + self._step_period)
        if self._client is None:
            return
        try:
            if self._sequencer.valves_open_output.Eval(context)[0] > 0.5:
                self._measured = self._client.send(self._sequencer.position_desired_output.Eval(context))
            else:
                self._measured = self._client.stop()
        except InputError as error:
            self._lost, self._client = str(error), None
        if self._arms is not None:
            self._measured = self._arms.advance()
