"""Messages of the link as text: angles in degrees, joystick deflections in percent, and words (thesis 5.2.6)."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits

Array = NDArray[np.float64]

STOP, RATE, SIGNALS = "STOP", "RATE", "SIGNALS"

_FULL = 100.0  # percent
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


def encode_rate(deflection: ArrayLike) -> bytes:
    """The line for 14 joystick deflections in percent."""
    return (",".join([RATE, *(f"{value:.1f}" for value in np.asarray(deflection))]) + "\n").encode("ascii")


def decode_rate(line: bytes) -> Array:
    """Deflections in percent, shape (14,), from a line that begins with `RATE`.

    Raises:
        InputError: Not 14 numbers from -100 to 100.
    """
    try:
        values = np.array([float(word) for word in line.decode("ascii").strip().split(",")[1:]])
    except ValueError:
        raise InputError(
            f"message {line[:40]!r} is not {RATE} and {_JOINTS} deflections in percent"
        ) from None
    if values.shape != (_JOINTS,):
        raise InputError(f"message has {len(values)} deflections; {_JOINTS} in percent are needed")
    for joint, value in enumerate(values):
        if not abs(value) <= _FULL:
            name = f"{SIDES[joint // 7]}_j{joint % 7 + 1}"
            raise InputError(f"deflection of {name} = {value:g} % is outside -100 to 100 %")
    return values
