"""Set points over TCP, in the form of thesis section 5.2.6: the console on one computer, the controllers on another.

A message is one line of ASCII text: 14 joint angles in degrees, `right_j1` ... `left_j7`, separated by commas;
`RATE` and 14 joystick deflections in percent, separated by commas; or `STOP`, which closes the valves. The answer is
one line with the measured angles in degrees. The controllers' end closes the valves when a message is malformed or
too long, when the client leaves or falls silent, and on STOP; set points and deflections open them again. `SIGNALS`
asks for voltages and pressures (`teleop/signals.py`); it opens nothing and does not count as a sign of life.
"""

import socket
import threading
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.messages import RATE, SIGNALS, STOP, decode, decode_rate, encode, encode_rate
from hydrolek_drake.teleop.signals import Signals, signals_from_line

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkOrder:
    """What the client wants now.

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


def silence(realtime_rate: float) -> float:
    """How long either end waits for the other [s]: `link.silence` of the machine's time, never less by the clock.

    Args:
        realtime_rate: Simulated seconds a second; 1 for a real machine.
    """
    return float(teleop_entries("link")["silence"] / min(1.0, realtime_rate))


class SetpointServer:
    """The controllers' end. One client at a time; a second one is refused.

    Args:
        posture: Set point until the first message, in rad, shape (14,).
        port: TCP port, 0 for any free one.
        host: Address to listen at; the loopback unless told otherwise.
        realtime_rate: Simulated seconds a second, of a simulated machine.
    """

    def __init__(
        self,
        posture: ArrayLike,
        *,
        port: int | None = None,
        host: str = "127.0.0.1",
        realtime_rate: float = 1.0,
    ) -> None:
        values = teleop_entries("link")
        self._silence, self._longest = silence(realtime_rate), int(values["longest_message"])
        self._lock = threading.Lock()
        self._desired = np.array(posture, dtype=float)
        self._measured = np.array(posture, dtype=float)
        self._deflection: Array | None = None
        self._signals: Signals | None = None
        self.message_came = threading.Event()
        self._open, self._reason, self._last = False, "no client yet", time.monotonic()
        wanted = int(values["port"]) if port is None else port
        try:
            self._listener = socket.create_server((host, wanted))
        except OSError as error:
            raise InputError(
                f"link: cannot listen at {host}:{wanted}: {error.strerror}; choose another port"
            ) from None
        self.port: int = self._listener.getsockname()[1]
        self._client: socket.socket | None = None
        self._closing = False
        self._threads = [threading.Thread(target=self._accept, name="link", daemon=True)]
        self._threads[0].start()

    def command(self) -> tuple[Array, bool, str]:
        """Set point in rad, whether the valves may be open, and if not, why."""
        order = self.order()
        return order.desired, order.valves_open, order.reason

    def order(self) -> LinkOrder:
        """What the client wants now; after silence, closed valves."""
        with self._lock:
            if self._open and time.monotonic() - self._last > self._silence:
                self._shut(f"no message for {self._silence:g} s")
            deflection = None if self._deflection is None or not self._open else self._deflection.copy()
            return LinkOrder(self._desired.copy(), deflection, self._open, self._reason)

    def report(self, measured: ArrayLike, signals: Signals | None = None) -> None:
        """Tell the client with the next answers where the joints are, in rad, shape (14,), and other signals."""
        with self._lock:
            self._measured, self._signals = np.array(measured, dtype=float), signals

    def close(self) -> None:
        """Close the valves, the client's connection and the port."""
        with self._lock:
            self._closing = True
            self._shut("the link was closed")
            client = self._client
        for each in (client, self._listener):
            if each is not None:
                try:
                    each.shutdown(socket.SHUT_RDWR)
                except OSError:
                    pass  # it has gone already
                each.close()

    def _shut(self, reason: str) -> None:
        self._open, self._reason, self._deflection = False, reason, None

    def _accept(self) -> None:
        while not self._closing:
            try:
                client, _ = self._listener.accept()
            except OSError:
                return  # closed
            with self._lock:
                busy = self._client is not None
                if not busy:
                    self._client = client
            if busy:
                client.sendall(b"BUSY: another client is connected\n")
                client.close()
            else:
                thread = threading.Thread(target=self._serve, args=(client,), name="link client", daemon=True)
                thread.start()

    def _serve(self, client: socket.socket) -> None:
        reason, pending = "the client has gone", b""
        try:
            with client:
                while True:
                    received = client.recv(4096)
                    if not received:
                        break
                    pending += received
                    *lines, pending = pending.split(b"\n")
                    for line in lines:
                        client.sendall(self._take(line))
                    if len(pending) > self._longest:
                        raise InputError(f"a message is longer than {self._longest} bytes")
        except InputError as error:
            reason = str(error)
        except OSError:
            pass  # the client has gone
        with self._lock:
            self._client = None
            self._shut(reason)

    def _take(self, line: bytes) -> bytes:
        """Act on a message; returns the answer."""
        if len(line) > self._longest:
            raise InputError(f"a message is longer than {self._longest} bytes")
        if line.strip() == SIGNALS.encode():
            with self._lock:
                return b"{}\n" if self._signals is None else self._signals.to_line()
        deflection = decode_rate(line) if line.startswith(RATE.encode()) else None
        angles = decode(line) if deflection is None else None
        with self._lock:
            if self._closing:  # a message that was under way opens nothing any more
                raise InputError("the link was closed")
            self._last = time.monotonic()
            if deflection is not None:
                self._deflection, self._open, self._reason = deflection, True, ""
            elif angles is None:
                self._shut("stopped by the operator")
            else:
                self._desired, self._deflection, self._open, self._reason = angles, None, True, ""
            answer = encode(self._measured)
        self.message_came.set()
        return answer


class SetpointClient:
    """The console's end.

    Args:
        port: TCP port of the controllers' end.
        host: Its address.
        realtime_rate: Simulated seconds a second, of a simulated machine.
    """

    def __init__(self, port: int, host: str = "127.0.0.1", *, realtime_rate: float = 1.0) -> None:
        try:
            self._socket = socket.create_connection((host, port), timeout=silence(realtime_rate))
        except OSError as error:
            raise InputError(
                f"link: no controllers answer at {host}:{port}: {error}; start them first"
            ) from None
        self._pending = b""

    def send(self, angles: ArrayLike) -> Array:
        """Send set points in rad and return the measured angles in rad, each of shape (14,).

        Raises:
            InputError: The link is lost.
        """
        return self._exchange(encode(angles))

    def rate(self, deflection: ArrayLike) -> Array:
        """Send joystick deflections in percent and return the measured angles in rad, each of shape (14,).

        Raises:
            InputError: The link is lost.
        """
        return self._exchange(encode_rate(deflection))

    def signals(self) -> Signals | None:
        """Voltages and pressures, or None from a machine that has none.

        Raises:
            InputError: The link is lost, or the controllers' end does not know the question.
        """
        return signals_from_line(self._ask(f"{SIGNALS}\n".encode("ascii")))

    def stop(self) -> Array:
        """Have the valves closed; returns the measured angles in rad.

        Raises:
            InputError: The link is lost.
        """
        return self._exchange(f"{STOP}\n".encode("ascii"))

    def close(self) -> None:
        """Leave; the valves close."""
        self._socket.close()

    def _exchange(self, message: bytes) -> Array:
        line = self._ask(message)
        try:
            return np.radians([float(word) for word in line.decode("ascii").split(",")])
        except ValueError:
            raise InputError(f"link: the controllers answered {line[:60]!r}") from None

    def _ask(self, message: bytes) -> bytes:
        try:
            self._socket.sendall(message)
            while b"\n" not in self._pending:
                received = self._socket.recv(4096)
                if not received:
                    raise InputError("link: the controllers closed the connection; the valves are closed")
                self._pending += received
        except OSError as error:
            raise InputError(f"link: lost, {error}; the valves are closed") from None
        line, self._pending = self._pending.split(b"\n", 1)
        return line
