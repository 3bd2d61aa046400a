"""Who may move the arms over the link, and whether the valves may be open: rules without sockets."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError

Array = NDArray[np.float64]


class BusyError(Exception):
    """A request that is understood and not carried out, since somebody else is in control or has stopped the arms."""


@dataclass(frozen=True)
class LinkOrder:
    """What the client in control wants now.

    Attributes:
        desired: Set point in rad, shape (14,).
        deflection: Of the joysticks in percent, shape (14,), if they lead; None if the set point does.
        valves_open: Whether the valves may be open.
        reason: If not, why.
    """

    desired: Array
    deflection: Array | None
    valves_open: bool
    reason: str


@dataclass(eq=False)
class Client:
    """One connection, as the rules see it.

    Attributes:
        trusted: Whether it has given the token, or none is asked for.
        dropped: Why it has lost the connection that it still holds, or empty.
        stops_seen: How many stops by others had been made when it last took note of them by CONTROL or STOP.
    """

    trusted: bool = True
    dropped: str = ""
    stops_seen: int = 0


class Authority:
    """One client is in control; anybody may stop the arms. Calls may come from any thread.

    Control is taken by the first message that leads the arms (CONTROL, set point, deflections, ALIVE, STOP) while
    nobody has it, and is lost by leaving, by a bad message, by a STOP of somebody else, and after `mute` seconds
    without such a message. The valves are open while the client in control sends set points or deflections, and close
    after `silence` seconds without a sign of life. After a STOP of somebody else, set points count only from a client
    that has sent CONTROL or STOP itself since: nobody starts the arms again without knowing that they were stopped.

    Args:
        posture: Set point until the first message, in rad, shape (14,).
        silence: Seconds after which the valves close.
        mute: Seconds after which control is free for the next one.
        clock: Seconds that never run backwards.
    """

    def __init__(
        self,
        posture: ArrayLike,
        *,
        silence: float,
        mute: float,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._silence, self._mute, self._clock = silence, mute, clock
        self._lock = threading.Lock()
        self._holder: Client | None = None
        self._stops = 0
        self._desired = np.array(posture, dtype=float)
        self._deflection: Array | None = None
        self._open, self._reason, self._last = False, "no client yet", clock()
        self._closed = False

    def order(self) -> LinkOrder:
        """What the client in control wants now; after silence, closed valves."""
        with self._lock:
            self._heed_silence()
            deflection = None if self._deflection is None or not self._open else self._deflection.copy()
            return LinkOrder(self._desired.copy(), deflection, self._open, self._reason)

    def lead(self, client: Client, *, angles: Array | None = None, deflection: Array | None = None) -> None:
        """Set point in rad or deflections in percent, shape (14,); with neither, a sign of life.

        Raises:
            BusyError: Somebody else is in control, or has stopped the arms.
            InputError: The link was closed.
        """
        with self._lock:
            self._take_control(client)
            if self._stops != client.stops_seen:
                raise BusyError("another client has stopped the arms; send CONTROL before new set points")
            self._heed_silence()
            self._last = self._clock()
            if deflection is not None:
                self._deflection, self._open, self._reason = deflection, True, ""
            elif angles is not None:
                self._desired, self._deflection, self._open, self._reason = angles, None, True, ""

    def take(self, client: Client) -> None:
        """Take control with the valves as they are, knowing of every stop so far.

        Raises:
            BusyError: Somebody else is in control.
            InputError: The link was closed.
        """
        with self._lock:
            self._take_control(client)
            self._heed_silence()
            self._last, client.stops_seen = self._clock(), self._stops

    def stop(self, client: Client) -> None:
        """Close the valves, whoever asks; who is in control loses it by the STOP of somebody else.

        Raises:
            InputError: The link was closed.
        """
        with self._lock:
            self._refuse_if_closed()
            other = self._in_control()
            if other is not None and other is not client:
                self._displace(other, "stopped by another client")
            else:
                if other is None:  # who comes next must know of it
                    self._stops += 1
                self._shut("stopped by the operator")
                if client.trusted:
                    self._holder, self._last = client, self._clock()
            client.stops_seen = self._stops

    def bad(self, client: Client, reason: str) -> None:
        """A message that is no message: the valves close, whoever sent it."""
        with self._lock:
            other = self._in_control()
            if other is not None and other is not client:
                self._displace(other, f"another client sent a bad message: {reason}")
            self._release(client, reason)

    def leave(self, client: Client, reason: str) -> None:
        """The connection has ended; if it was in control, the valves close."""
        with self._lock:
            if self._holder is client:
                self._release(client, reason)

    def in_control(self, client: Client) -> bool:
        """Whether this one is in control."""
        with self._lock:
            return self._in_control() is client

    def close(self, reason: str) -> None:
        """Close the valves for good; a message that is under way opens nothing any more."""
        with self._lock:
            self._closed = True
            self._shut(reason)

    def _take_control(self, client: Client) -> None:
        self._refuse_if_closed()
        if self._in_control() not in (None, client):
            raise BusyError("another client is in control")
        self._holder = client

    def _in_control(self) -> Client | None:
        if self._holder is not None and self._clock() - self._last > self._mute:
            self._holder = None
        return self._holder

    def _heed_silence(self) -> None:
        if self._open and self._clock() - self._last > self._silence:
            self._shut(f"no message for {self._silence:g} s")

    def _displace(self, other: Client, reason: str) -> None:
        other.dropped = reason
        self._stops += 1
        self._holder = None
        self._shut(reason)

    def _release(self, client: Client, reason: str) -> None:
        if self._holder is client:
            self._holder = None
        self._shut(reason)

    def _shut(self, reason: str) -> None:
        if not self._closed or self._open:
            self._open, self._reason, self._deflection = False, reason, None

    def _refuse_if_closed(self) -> None:
        if self._closed:
            raise InputError("the link was closed")
