"""Runs a machine behind the link, sample by sample, until told to end; whatever ends it, the valves close."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import replace

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.adapter import Arms, checked
from hydrolek_drake.teleop.link.server import SetpointServer

_LOG = logging.getLogger(__name__)
_PACE_WINDOW = 20  # samples over which the pace is measured


class Clock:
    """Keeps a real machine's samples to the clock, and says when they come late.

    Args:
        period: Seconds between two samples.
    """

    def __init__(self, period: float) -> None:
        self._period, self._due, self._told = period, time.monotonic(), -float("inf")

    def wait(self) -> None:
        """Return when the next sample is due."""
        now = time.monotonic()
        behind = now - self._due
        if behind > self._period and now - self._told > teleop_entries("link")["told_again"]:
            self._told = now
            _LOG.warning(
                "serve: the machine's samples are %.0f ms late; a sample is %.0f ms",
                1e3 * behind,
                1e3 * self._period,
            )
        time.sleep(max(0.0, -behind))
        self._due = max(self._due, now - self._period) + self._period


class Pacer:
    """Keeps a simulated plant to the clock, one sample for each message while messages come.

    A controller that took a sample without a new set point would see the machine's target stand still and then jump.
    On a busy computer the plant therefore waits for a message that is late, for `plant.patience`; without a client it
    does not.

    Args:
        server: Whose messages are waited for.
        period: Simulated seconds a sample.
        realtime_rate: Simulated seconds a second.
    """

    def __init__(self, server: SetpointServer, period: float, realtime_rate: float) -> None:
        self._server, self._sample, self._period = server, period, period / realtime_rate
        entries = teleop_entries("plant")
        self._lead, self._lag = entries["lead"] / realtime_rate, entries["lag"] / realtime_rate
        self._patience, self._followed = entries["patience"] / realtime_rate, False
        self._due = time.monotonic()
        self._began = [self._due]

    def wait(self) -> None:
        """Return when the next sample is to be simulated: at a message, or when none comes in time."""
        late = self._due + (self._patience if self._followed else 0.5 * self._period)
        self._followed = self._server.message_came.wait(timeout=max(0.0, late - time.monotonic()))
        self._server.message_came.clear()
        time.sleep(max(0.0, self._due - self._lead - time.monotonic()))
        now = time.monotonic()
        self._due = max(self._due + self._period, now - self._lag)
        self._began = [*self._began[-_PACE_WINDOW:], now]

    def pace(self) -> float:
        """Simulated seconds a second over the last samples."""
        took = self._began[-1] - self._began[0]
        return (len(self._began) - 1) * self._sample / took if took > 0.0 else 1.0


def serve_arms(
    arms: Arms,
    server: SetpointServer,
    *,
    wait: Callable[[], None],
    ended: threading.Event,
    pace: Callable[[], float] | None = None,
    after: Callable[[], None] | None = None,
) -> None:
    """Run the machine behind the link until `ended`.

    Args:
        arms: The machine.
        server: The link.
        wait: Returns when the next sample is due.
        ended: When to stop.
        pace: How fast a simulated machine runs, in simulated seconds a second.
        after: Called after each sample.

    Raises:
        InputError: The machine failed, with its reason; the valves are closed.
    """
    reason = "the controllers have ended"
    try:
        while not ended.is_set():
            wait()
            arms.advance(server.order())
            signals = arms.signals()
            if signals is not None and pace is not None:
                signals = replace(signals, pace=pace())
            server.report(checked(arms.measured(), type(arms).__name__), signals)
            if after is not None:
                after()
    except Exception as error:
        reason = f"the machine failed: {error}"
        if isinstance(error, InputError):
            raise
        raise InputError(f"serve: {reason} ({type(error).__name__}); the valves are closed") from error
    finally:
        try:
            arms.close()  # valves before sockets
        finally:
            server.close(reason)
