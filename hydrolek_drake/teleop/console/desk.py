"""What pages and sockets of the console work with: session, rules, and what a browser may ask for; no web server."""

import asyncio
import contextlib
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Protocol

from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.console import messages
from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.seats import Seated, Seats
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.teleop.trial import TrialLog


class Browser(Seated, Protocol):
    """A browser, as the console sends to it."""

    def show(self, state: dict[str, Any], in_control: bool, watching: int) -> None:
        """Send a state."""

    def close(self) -> None:
        """End the connection."""


class Desk:
    """A session, who may work at it, and the threads in which that is done.

    Attributes:
        session: What the operator works at.
        gate: Who may speak to the console.
        trials: Timed trials and their ratings.
        view_port: Of Drake's browser view, or None.
        most: Browsers at once.
        seats: Who is in control.
        stops: How many STOPs have come; what was asked for before one is not done after it.
        workers: Threads for all but STOP.
    """

    def __init__(self, session: OperatorSession, gate: Gate, trials: TrialLog, view_port: int | None) -> None:
        self.session, self.gate, self.trials, self.view_port = session, gate, trials, view_port
        limits = teleop_entries("console")
        self.most = int(limits["browsers"])
        self.seats: Seats[Browser] = Seats(limits["mute"], self._control_lost)
        self.stops = 0
        self.workers = ThreadPoolExecutor(2, thread_name_prefix="console")
        # never waits for a camera or a planner
        self._stopper = ThreadPoolExecutor(1, thread_name_prefix="stop")

    def end_work(self) -> None:
        """Wait for what has been begun; nothing more is."""
        self.workers.shutdown(wait=True, cancel_futures=True)
        self._stopper.shutdown(wait=True)

    def _control_lost(self) -> None:
        """The arms must not go on without somebody who sees them; does not wait for the machine."""
        with contextlib.suppress(RuntimeError):  # the console is closed, and the machine with it
            self._stopper.submit(self.session.lose_operator)

    async def stop(self) -> None:
        """Stop the arms at once, whatever else is going on, then tell the session so."""
        loop = asyncio.get_running_loop()
        await loop.run_in_executor(self._stopper, self.session.halt)
        await loop.run_in_executor(self.workers, self.session.order, Order.STOP)

    def act(self, message: messages.AnyMessage) -> None:
        """Do what the browser in control asks for.

        Raises:
            InputError: It is not possible now.
        """
        session = self.session
        match message:
            case messages.Click(u=u, v=v):
                session.click(u, v)
            case messages.Sliders():
                session.set_sliders(**message.given())
            case messages.Fill(name=name):
                session.set_fill(name)
            case messages.TaskChoice(name=name):
                session.set_task(name)
            case messages.Joystick(deflection=deflection):
                session.move_by_hand(deflection=deflection)
            case messages.SlidersTo(angles_deg=angles):
                session.move_by_hand(towards_deg=angles)
            case messages.Timer(action=action):
                self.trials.timer(action)
            case messages.Ratings():
                self.trials.save(message.given())
            case messages.Plain(do="resume"):
                session.order(Order.RESUME)
            case messages.Plain(do="abort"):
                session.order(Order.ABORT)
            case messages.Plain(do=what):
                getattr(session, what)()
