"""The console's end of the link."""

import socket
import time

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.link.messages import Word, decode_answer, encode, encode_rate, encode_word
from hydrolek_drake.teleop.link.server import silence
from hydrolek_drake.teleop.link.signals import Signals, signals_from_line

Array = NDArray[np.float64]

_LONGEST_ANSWER = 65536  # bytes; signals of 14 joints take 1,500


class SetpointClient:
    """Sends one line and waits for its answer, each call; `link.silence` of teleop.yaml at most.

    Args:
        port: TCP port of the controllers' end.
        host: Its address.
        realtime_rate: Simulated seconds a second, of a simulated machine.
        token: What the controllers' end asks for, if it does.

    Raises:
        InputError: Nobody answers, or the token is refused.
    """

    def __init__(
        self, port: int, host: str = "127.0.0.1", *, realtime_rate: float = 1.0, token: str | None = None
    ) -> None:
        self._patience = silence(realtime_rate)
        try:
            self._socket = socket.create_connection((host, port), timeout=self._patience)
        except (OSError, OverflowError, UnicodeError) as error:
            raise InputError(
                f"link: no controllers answer at {host}:{port}: {error}; start them first"
            ) from None
        self._pending = b""
        if token is not None:
            answer = self._ask(encode_word(Word.TOKEN, token))
            if answer.strip() != b"OK":
                self.close()
                decode_answer(answer)  # a refusal, with its reason
                raise InputError(f"link: the controllers answered the token with {answer[:60]!r}")

    def send(self, angles: ArrayLike) -> Array:
        """Send set points in rad and return the measured angles in rad, each of shape (14,).

        Raises:
            InputError: The link is lost.
        """
        return decode_answer(self._ask(encode(angles)))

    def rate(self, deflection: ArrayLike) -> Array:
        """Send joystick deflections in percent and return the measured angles in rad, each of shape (14,).

        Raises:
            InputError: The link is lost.
        """
        return decode_answer(self._ask(encode_rate(deflection)))

    def control(self) -> Array:
        """Take control, valves closed; returns the measured angles in rad, shape (14,).

        Raises:
            InputError: The link is lost, or somebody else is in control.
        """
        return decode_answer(self._ask(encode_word(Word.CONTROL)))

    def alive(self) -> Array:
        """Keep the last set point or deflections; returns the measured angles in rad, shape (14,).

        Raises:
            InputError: The link is lost.
        """
        return decode_answer(self._ask(encode_word(Word.ALIVE)))

    def signals(self) -> Signals | None:
        """Voltages and pressures, or None from a machine that has none.

        Raises:
            InputError: The link is lost, or the controllers' end does not know the question.
        """
        return signals_from_line(self._ask(encode_word(Word.SIGNALS)))

    def stop(self) -> Array:
        """Have the valves closed; returns the measured angles in rad.

        Raises:
            InputError: The link is lost.
        """
        return decode_answer(self._ask(encode_word(Word.STOP)))

    def close(self) -> None:
        """Leave; the valves close."""
        self._socket.close()

    def _ask(self, message: bytes) -> bytes:
        deadline = time.monotonic() + self._patience
        try:
            self._socket.settimeout(self._patience)
            self._socket.sendall(message)
            while b"\n" not in self._pending:
                if len(self._pending) > _LONGEST_ANSWER:
                    raise InputError(f"link: an answer is longer than {_LONGEST_ANSWER} bytes")
                self._socket.settimeout(max(deadline - time.monotonic(), 1e-3))
                received = self._socket.recv(4096)
                if not received:
                    raise InputError("link: the controllers closed the connection; the valves are closed")
                self._pending += received
        except OSError as error:
            raise InputError(f"link: lost, {error}; the valves are closed") from None
        line, self._pending = self._pending.split(b"\n", 1)
        return line
