"""Sine and cosine of joint angles, which hardly change within one row of a rollout.

There they follow from those at the row's beginning by the addition theorems, sin(a + d) = sin a cos d + cos a sin d,
with the series of sin d and cos d (Abramowitz, Stegun, Handbook of Mathematical Functions, 4.3.16, 4.3.17, 4.3.65,
4.3.66): calls of the library's functions took a sixth of a rollout's time.
"""

import math
from typing import NamedTuple

from hydrolek_drake.compiling import njit

CLOSE = 0.05
"""Within so many radians what the series leave out is below 1e-17, less than rounding."""

_S3, _S5, _S7 = -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0
_C2, _C4, _C6, _C8 = -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0


class Angle(NamedTuple):
    """An angle with its sine and cosine."""

    value: float  # [rad]
    sine: float
    cosine: float


_PLAIN = len(Angle._fields)


class AngleKept(NamedTuple):
    """An angle that is carried on from step to step, so that none that is asked for is farther from it than `CLOSE`."""

    value: float
    sine: float
    cosine: float
    kept: bool


@njit
def angle(value: float) -> Angle:
    """An angle [rad] with its sine and cosine from the library."""
    return Angle(value, math.sin(value), math.cos(value))


@njit
def angle_near(value: float, known: Angle | AngleKept) -> Angle:
    """The same as `angle`, to rounding, from an angle that is known: by the series where it is close to it.

    Of one that is kept the library's functions are not even compiled in: a call keeps a loop from vector instructions.
    """
    d = value - known.value
    if len(known) == _PLAIN and not abs(d) < CLOSE:
        return angle(value)
    e = d * d
    sine = d + d * e * (_S3 + e * (_S5 + e * _S7))
    cosine = 1.0 + e * (_C2 + e * (_C4 + e * (_C6 + e * _C8)))
    return Angle(value, known.sine * cosine + known.cosine * sine, known.cosine * cosine - known.sine * sine)
