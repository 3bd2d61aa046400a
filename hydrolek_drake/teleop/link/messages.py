"""Messages of the link as lines of text, version 1 (thesis section 5.2.6; docs/reference/link.md has them all).

Whoever asks sends one line and gets one line. A request is 14 joint angles in degrees, `RATE` with 14 joystick
deflections in percent, or one of the words below. The answer to angles, deflections, `STOP`, `CONTROL` and `ALIVE` is
the 14 measured angles in degrees; a refusal begins with `BUSY` or `ERROR`.
"""

import math
from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits

Array = NDArray[np.float64]

VERSION = 1


class Word(str, Enum):
    """First word of a request that is more than angles."""

    STOP = "STOP"
    CONTROL = "CONTROL"
    RATE = "RATE"
    ALIVE = "ALIVE"
    SIGNALS = "SIGNALS"
    STATUS = "STATUS"
    VERSION = "VERSION"
    TOKEN = "TOKEN"


BUSY, ERROR = "BUSY", "ERROR"

_FULL = 100.0  # percent
_JOINTS = 14
_ROUNDING_DEG = 1e-3  # of angles as text


@dataclass(frozen=True)
class Request:
    """A request that was understood.

    Attributes:
        word: What is asked for; None for a set point.
        angles: Set point in rad, shape (14,), if there is no word.
        deflection: Of the joysticks in percent, shape (14,), of `RATE`.
        text: What follows `TOKEN`.
    """

    word: Word | None
    angles: Array | None = None
    deflection: Array | None = None
    text: str = ""


def encode(angles: ArrayLike) -> bytes:
    """The line for 14 joint angles in rad."""
    return (",".join(f"{value:.4f}" for value in np.degrees(angles)) + "\n").encode("ascii")


def encode_rate(deflection: ArrayLike) -> bytes:
    """The line for 14 joystick deflections in percent."""
    words = [Word.RATE.value, *(f"{value:.1f}" for value in np.asarray(deflection))]
    return (",".join(words) + "\n").encode("ascii")


def encode_word(word: Word, text: str = "") -> bytes:
    """The line for a word, and what follows it."""
    return (word.value + (f" {text}" if text else "") + "\n").encode("ascii")


def decode(line: bytes) -> Request:
    """Read a request.

    Raises:
        InputError: No request of this protocol, or a number outside its range.
    """
    try:
        text = line.decode("ascii").strip()
    except ValueError:
        raise _unknown(line) from None
    first, _, rest = text.partition(" ")
    if text.partition(",")[0].strip() == Word.RATE.value:
        return Request(Word.RATE, deflection=_deflection(line, text))
    if first == Word.TOKEN.value:
        return Request(Word.TOKEN, text=rest.strip())
    if first == Word.VERSION.value:
        if rest.strip() not in ("", str(VERSION)):
            raise InputError(f"version {rest.strip()[:20]} of the protocol is not known here; {VERSION} is")
        return Request(Word.VERSION)
    if text in [word.value for word in Word]:
        return Request(Word(text))
    return Request(None, angles=_angles(line, text))


def decode_answer(line: bytes) -> Array:
    """Measured angles in rad, shape (14,), from an answer.

    Raises:
        InputError: A refusal, with its reason, or no answer of this protocol.
    """
    text = line.decode("ascii", errors="replace").strip()
    if text.startswith((BUSY, ERROR)):
        raise InputError(f"link: the controllers refuse: {text.partition(' ')[2]}")
    try:
        degrees = np.array([_number(word) for word in text.split(",")])
    except ValueError:
        degrees = np.zeros(0)
    if degrees.shape != (_JOINTS,) or not np.isfinite(degrees).all():
        raise InputError(f"link: the controllers answered {line[:60]!r}, not {_JOINTS} angles in degrees")
    return np.radians(degrees)


def _angles(line: bytes, text: str) -> Array:
    degrees = _numbers(line, text.split(","), "angles", "in degrees")
    limits = [joint_limits(side) for side in SIDES]
    lower, upper = (np.degrees(np.concatenate([each[i] for each in limits])) for i in (0, 1))
    for joint, value in enumerate(degrees):
        if (
            not math.isfinite(value)
            or not lower[joint] - _ROUNDING_DEG <= value <= upper[joint] + _ROUNDING_DEG
        ):
            raise InputError(
                f"{_name(joint)} = {value:g} deg is outside its travel of {lower[joint]:.2f} to {upper[joint]:.2f} deg"
            )
    return np.radians(degrees)


def _deflection(line: bytes, text: str) -> Array:
    values = _numbers(line, text.split(",")[1:], "deflections", f"in percent behind {Word.RATE.value}")
    for joint, value in enumerate(values):
        if not abs(value) <= _FULL:
            raise InputError(f"deflection of {_name(joint)} = {value:g} % is outside -100 to 100 %")
    return values


def _numbers(line: bytes, words: list[str], what: str, unit: str) -> Array:
    try:
        values = np.array([_number(word) for word in words])
    except ValueError:
        raise _unknown(line) from None
    if values.shape != (_JOINTS,):
        raise InputError(f"message has {len(values)} {what}; {_JOINTS} {unit} are needed")
    return values


def _number(word: str) -> float:
    """A number as instruments write it; Python's own 1_0 for 10 would be a slip that moves the arms.

    Raises:
        ValueError: It is none.
    """
    if "_" in word:
        raise ValueError
    return float(word)


def _unknown(line: bytes) -> InputError:
    words = ", ".join(word.value for word in Word if word is not Word.RATE)
    return InputError(
        f"message {line[:40]!r} is not {_JOINTS} angles in degrees, {Word.RATE.value} and {_JOINTS} deflections in "
        f"percent, or a word of {words}"
    )


def _name(joint: int) -> str:
    return f"{SIDES[joint // 7]}_j{joint % 7 + 1}"
