"""Set points over TCP, in the form of thesis section 5.2.6: the console on one computer, the controllers on another.

A message is one line of ASCII text: 14 joint angles in degrees, `right_j1` ... `left_j7`, separated by commas; or
`STOP`, which closes the valves. The answer is one line of the same form with the measured angles. The controllers'
end closes the valves when a message is malformed or too long, when the client leaves or falls silent, and on STOP;
set points open them again.
"""

import math
import socket
import threading
import time

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.teleop.configuration import teleop_entries

Array = NDArray[np.float64]

STOP = "STOP"
_JOINTS = 14
_ROUNDING_DEG = 1e-3  # of angles as text


def encode(angles: ArrayLike) -> bytes:
    """The line for 14 joint angles in rad."""
    return (",".join(f"{value:.4f}" for value in np.degrees(angles)) + "\n").encode("ascii")


def decode(line: bytes) -> Array | None:
    """Joint angles in rad, shape (14,), or None for STOP.

    Raises:
        InputError: Anything else, or an angle outside the joint's limits.
    """
    try:
        text = line.decode("ascii").strip()
        if text == STOP:
            return None
        degrees = [float(word) for word in text.split(",")]
    except ValueError:
        raise InputError(f"message {line[:40]!r} is not {_JOINTS} angles in degrees or {STOP}") from None
    if len(degrees) != _JOINTS:
        raise InputError(f"message has {len(degrees)} angles; {_JOINTS} in degrees are needed")
    limits = [joint_limits(side) for side in SIDES]
    lower, upper = (np.degrees(np.concatenate([each[i] for each in limits])) for i in (0, 1))
    for joint, value in enumerate(degrees):
        if (
            not math.isfinite(value)
            or not lower[joint] - _ROUNDING_DEG <= value <= upper[joint] + _ROUNDING_DEG
        ):
            name = f"{SIDES[joint // 7]}_j{joint % 7 + 1}"
            raise InputError(
                f"{name} = {value:g} deg is outside its travel of {lower[joint]:.2f} to {upper[joint]:.2f} deg"
            )
    return np.radians(degrees)


class SetpointServer:
    """The controllers' end. One client at a time; a second one is refused.

    Args:
        posture: Set point until the first message, in rad, shape (14,).
        port: TCP port, 0 for any free one.
        host: Address to listen at; the loopback unless told otherwise.
    """

    def __init__(self, posture: ArrayLike, *, port: int | None = None, host: str = "127.0.0.1") -> None:
        values = teleop_entries("link")
        self._silence, self._longest = values["silence"], int(values["longest_message"])
        self._lock = threading.Lock()
        self._desired = np.array(posture, dtype=float)
        self._measured = np.array(posture, dtype=float)
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
        with self._lock:
            if self._open and time.monotonic() - self._last > self._silence:
                self._shut(f"no message for {self._silence:g} s")
            return self._desired.copy(), self._open, self._reason

    def report(self, measured: ArrayLike) -> None:
        """Tell the client with the next answer where the joints are, in rad, shape (14,)."""
        with self._lock:
            self._measured = np.array(measured, dtype=float)

    def close(self) -> None:
        """Close the valves, the client's connection and the port."""
        self._closing = True
        with self._lock:
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
        self._open, self._reason = False, reason

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
                        self._take(line)
                        with self._lock:
                            answer = encode(self._measured)
                        client.sendall(answer)
                    if len(pending) > self._longest:
                        raise InputError(f"a message is longer than {self._longest} bytes")
        except InputError as error:
            reason = str(error)
        except OSError:
            pass  # the client has gone
        with self._lock:
            self._client = None
            self._shut(reason)

    def _take(self, line: bytes) -> None:
        if len(line) > self._longest:
            raise InputError(f"a message is longer than {self._longest} bytes")
        angles = decode(line)
        with self._lock:
            self._last = time.monotonic()
            if angles is None:
                self._shut("stopped by the operator")
            else:
                self._desired, self._open, self._reason = angles, True, ""


class SetpointClient:
    """The console's end.

    Args:
        port: TCP port of the controllers' end.
        host: Its address.
    """

    def __init__(self, port: int, host: str = "127.0.0.1") -> None:
        timeout = teleop_entries("link")["silence"]
        try:
            self._socket = socket.create_connection((host, port), timeout=timeout)
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
        try:
            return np.radians([float(word) for word in line.decode("ascii").split(",")])
        except ValueError:
            raise InputError(f"link: the controllers answered {line[:60]!r}") from None
