"""The moving side of the console: sequencer, link and arms, each stepped in real time by a thread."""

import logging
import threading
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydrake.systems.analysis import Simulator

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.arms_end import ArmsEnd
from hydrolek_drake.teleop.controllers.plant_process import PlantProcess
from hydrolek_drake.teleop.hand import JOYSTICK, SLIDERS, Hand
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.link.reconnecting_client import ReconnectingClient
from hydrolek_drake.teleop.link.server import silence
from hydrolek_drake.teleop.link.signals import Signals
from hydrolek_drake.teleop.machine_state import MachineState
from hydrolek_drake.teleop.sequencer import Mode, Order, TaskSequencer
from hydrolek_drake.teleop.steps import OPENING, TaskPlan
from hydrolek_drake.workcell.pipe import Pipe
from hydrolek_drake.workcell.table import Table

Array = NDArray[np.float64]

_LOG = logging.getLogger(__name__)

_WITHDRAWN = 4
"""Periods without a set point before a task, and before the jaw opens: more than one, since one may come between two
samples of the controllers, and twice that where the plant falls behind."""

_SIGN_OF_LIFE = 0.5
"""A plant that is slow hears its set points again after this share of the silence by which it would count the link as
lost."""


class Machine:
    """Runs tasks: the sequencer here, the set points over the link, the arms at its other end.

    A lost link stops the task. It is sought again each `link.again` seconds of teleop.yaml; once it is back, the
    arms stand still until the operator resumes the task.

    The operator may also move joints by hand, by joystick or sliders. Whoever does so must say it again and again:
    a joystick that is silent for `manual.hold` of teleop.yaml counts as let go, and the valves close. After a stop
    nothing moves by hand before everything has been let go.

    Args:
        posture: Joints at first, in rad, shape (14,).
        controllers: Host and port of the controllers' end.
        token: What it asks for, if it does.
        plant: The hydraulic plant instead; it ends with the machine. With neither, the simple simulated arms.
        realtime_rate: Simulated seconds a second; tests run faster.
        pipe: The simulated pipe, where it is loose.
        table: What it stands on; for the simple arms, since the hydraulic plant has its own.
    """

    def __init__(
        self,
        posture: Array,
        *,
        controllers: tuple[str, int] | None = None,
        token: str | None = None,
        plant: PlantProcess | None = None,
        realtime_rate: float = 1.0,
        pipe: Pipe | None = None,
        table: Table | None = None,
    ) -> None:
        self._plant, self._pipe = plant, pipe
        self._signals: Signals | None = None
        self._plant_time, self._sent_at = -1.0, -np.inf
        if plant is not None:
            controllers, token = ("127.0.0.1", plant.port), plant.token
        self._arms = ArmsEnd(posture, pipe=pipe, table=table) if controllers is None else None
        if self._arms is not None:
            controllers, token = ("127.0.0.1", self._arms.server.port), self._arms.token
        assert controllers is not None  # given, or the plant's, or the simple arms'
        self._rate = realtime_rate
        self._link = ReconnectingClient(controllers, realtime_rate=realtime_rate, token=token)
        client = self._link.client
        assert client is not None  # it was refused with an error otherwise
        self._sequencer = TaskSequencer()
        self._simulator = Simulator(self._sequencer)
        self._period = teleop_entries("task")["period"] / realtime_rate
        self._step_period = teleop_entries("task")["period"]
        self._lock = threading.Lock()
        self._measured = client.control()
        self._order = Order.NONE
        self._hand, self._withdrawn = Hand(), 0
        self._last_step = ""
        self._running = True
        self._thread = threading.Thread(target=self._run, name="machine", daemon=True)
        self._thread.start()

    def start(self, plan: TaskPlan) -> None:
        """Begin a task.

        Raises:
            InputError: One is running, the arms have moved since it was planned, or the link is lost.
        """
        with self._lock:
            if self._link.lost:
                raise InputError(self._link.lost)
            self._hand.let_go()
            self._withdrawn = _WITHDRAWN
            self._sequencer.start(self._simulator.get_mutable_context(), plan, self._measured)

    def order(self, order: Order) -> None:
        """Stop at once, resume, or abort.

        Raises:
            InputError: A task is to be resumed while the link is lost.
        """
        with self._lock:
            if self._link.lost and order is Order.RESUME:
                raise InputError(self._link.lost)
            if order in (Order.STOP, Order.ABORT):
                self._hand.block()
            if order is self._order:  # the same again: let the sequencer see a change
                self._tick(Order.NONE)
            self._order = order
            self._tick(order)

    def move_by_hand(self, *, deflection: Array | None = None, towards: Array | None = None) -> None:
        """Move joints by joystick or towards the sliders' angles, until `let_go`, silence, or a stop.

        Args:
            deflection: In percent, shape (14,).
            towards: Angles in rad, shape (14,), instead; the joints go there at the planner's speed.

        Raises:
            InputError: A task is running or halted, the numbers are wrong, or the link is lost.
        """
        with self._lock:
            self._hand.check(deflection, towards)  # told whatever state the link is in
            if self._link.lost:
                raise InputError(self._link.lost)
            context: Any = self._simulator.get_mutable_context()
            mode = self._sequencer.mode(context)
            if mode in (Mode.RUNNING, Mode.STOPPED, Mode.TIMED_OUT):
                raise InputError("a task is under way; abort it before you move joints by hand")
            if mode is Mode.DONE:  # what it holds must not be held against the hand
                self._order = Order.NONE
                self._tick(Order.NONE)
                self._order = Order.ABORT
                self._tick(Order.ABORT)
            self._hand.move(self._measured, deflection, towards)

    def let_go(self) -> None:
        """Joystick and sliders are let go: the valves close."""
        with self._lock:
            self._hand.let_go()

    def state(self) -> MachineState:
        """What the console shows now."""
        with self._lock:
            context = self._simulator.get_context()
            mode, number, seconds, planned = self._sequencer.progress_output.Eval(context)
            by_hand = self._hand.moving()
            open_ = bool(self._sequencer.valves_open_output.Eval(context)[0]) or bool(by_hand)
            desired = np.array(self._sequencer.position_desired_output.Eval(context))
            if self._hand.set_point is not None:
                desired = self._hand.set_point.copy()
            elif Mode(int(mode)) in (Mode.IDLE, Mode.ABORTED):  # nothing is wanted
                desired = self._measured.copy()
            return MachineState(
                Mode(int(mode)),
                self._sequencer.step_name(context),
                int(number),
                float(seconds),
                float(planned),
                self._measured.copy(),
                desired,
                open_ and not self._link.lost,
                self._link.lost,
                by_hand,
                self._signals,
                self._pipe_now(),
            )

    def _pipe_now(self) -> Pipe | None:
        if self._arms is not None:
            return self._arms.pipe
        if self._pipe is None or self._signals is None or not np.isfinite(self._signals.pipe_place).all():
            return None
        return self._pipe.at(self._signals.pipe_place)

    def close(self) -> None:
        """Close the valves and end the thread."""
        self._running = False
        self._thread.join(timeout=2.0)
        self._link.close()
        if self._arms is not None:
            self._arms.server.close()
        if self._plant is not None:
            self._plant.close()

    def _run(self) -> None:
        following = time.monotonic()
        while self._running:
            try:
                with self._lock:
                    self._tick(self._order, waiting=self._behind())
                if self._link.client is None:
                    self._seek_link()
            except Exception as error:  # nothing ends this thread: without it nobody could stop a task
                _LOG.exception("teleop: a period of the task failed; the valves are closed")
                with self._lock:
                    self._lose(
                        f"a period of the task failed ({type(error).__name__}: {error}); the valves are closed"
                    )
                self._link.wait()
            following += self._period
            time.sleep(max(0.0, following - time.monotonic()))
            following = max(following, time.monotonic())  # after a pause, do not run to catch up

    def _behind(self) -> bool:
        """Whether the plant has not simulated another period yet: on a slow computer the task waits for it."""
        client = self._link.client
        if self._plant is None or client is None:
            return False
        try:
            self._signals = client.signals()
        except InputError as error:
            self._lose(str(error))
        if self._signals is None:
            return False
        before, self._plant_time = self._plant_time, self._signals.time
        return self._plant_time == before

    def _tick(self, order: Order, *, waiting: bool = False) -> None:
        """One period: measured joints into the sequencer, its set points over the link, the arms follow.

        Args:
            order: Of the operator.
            waiting: Whether the task's time stands still, and no set point is sent either: the same one again would
                look like a target that stands still.
        """
        context: Any = self._simulator.get_mutable_context()
        if not waiting:
            self._sequencer.position_measured_input.FixValue(context, self._measured)
            self._advance(context, order)
            self._free_the_jaw(self._sequencer.step_name(context))
        client = self._link.client
        if client is None:
            return
        if not waiting or time.monotonic() - self._sent_at > _SIGN_OF_LIFE * silence(self._rate):
            self._sent_at = time.monotonic()
            try:
                self._measured = self._exchange(client, context)
            except InputError as error:
                self._lose(str(error))
        if self._arms is not None:
            self._measured = self._arms.advance()

    def _advance(self, context: Any, order: Order) -> None:
        self._sequencer.order_input.FixValue(context, [float(order)])
        try:
            self._simulator.AdvanceTo(self._sequencer.one_update_on(context))
        except Exception:
            self._simulator.Initialize()  # without it Drake's simulator does nothing more
            raise

    def _lose(self, reason: str) -> None:
        """The link is lost: the task stops, and goes on only if the operator says so."""
        context: Any = self._simulator.get_mutable_context()
        self._link.lose(reason)
        self._signals = None
        self._hand.block()
        self._order = Order.STOP
        for order in (Order.NONE, Order.STOP):  # the sequencer heeds a change
            self._advance(context, order)

    def _seek_link(self) -> None:
        """Try to have the link back, with closed valves."""
        found = self._link.seek()  # it may wait for an answer: not under the lock
        if found is None:
            return
        client, measured = found
        with self._lock:
            self._link.regain(client)
            self._measured = measured

    def _free_the_jaw(self, step: str) -> None:
        """Withdraw the set points for a moment as the jaw is to open: it may have pushed in vain all the while."""
        if step != self._last_step and step == OPENING:
            self._withdrawn = _WITHDRAWN
        self._last_step = step

    def _exchange(self, client: SetpointClient, context: Any) -> Array:
        """Send what the arms are to do now; returns the measured joints."""
        if self._withdrawn > 0:  # a gripper that pushed in vain heeds no set point before it has had none
            self._withdrawn -= 1
            return client.stop()
        if self._sequencer.valves_open_output.Eval(context)[0] > 0.5:
            return client.send(self._sequencer.position_desired_output.Eval(context))
        by_hand = self._hand.moving()
        if by_hand == JOYSTICK:
            return client.rate(self._hand.deflection)
        if by_hand == SLIDERS:
            return client.send(self._hand.step(self._step_period))
        return client.stop()
