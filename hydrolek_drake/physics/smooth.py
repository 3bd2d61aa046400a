"""Exponential, logarithm, hyperbolic tangent, sine and cosine in plain arithmetic, for loops over machines in lanes.

The mathematical library's functions are calls, of which no compiler makes vector instructions. e^x = 2^n e^r with n the
nearest whole number to x / ln 2 and |r| <= ln 2 / 2, for which the series (Abramowitz, Stegun, Handbook of Mathematical
Functions, 4.2.1) is at rounding after thirteen terms; tanh x = (1 - e^(-2x)) / (1 + e^(-2x)) (4.5.26). Sine and cosine
by their series (4.3.65, 4.3.66) up to a quarter turn, and of twice the angle by 4.3.24 and 4.3.25.
"""

import math
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic

from hydrolek_drake.compiling import njit

_PER_LN2 = 1.0 / math.log(2.0)
_LN2_HIGH = 0.693147180369123816490  # ln 2 in two parts: the product of this one with a whole number is exact
_LN2_LOW = 1.90821492927058770002e-10
_LOWEST, _HIGHEST = -700.0, 700.0  # beyond, e^x is no normal number
_ROUNDING = 1.5 * 2.0**52  # added to a number, it leaves the nearest whole one in the lowest bits
_BIAS, _MANTISSA_BITS = 1023, 52  # of a float64
_HALF_ROOT_BITS = int(np.float64(math.sqrt(0.5)).view(np.int64))


@intrinsic
def _as_float(typing_context: Any, bits: Any) -> Any:
    """The float64 that has these bits."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.float64))

    return types.float64(types.int64), generate


@intrinsic
def _as_bits(typing_context: Any, value: Any) -> Any:
    """The bits of a float64."""

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return builder.bitcast(arguments[0], context.get_value_type(types.int64))

    return types.int64(types.float64), generate


@njit
def exponential(x: float) -> float:
    """e^x, to 4e-16 of it from -700 to 700; beyond, the value at the nearer end, which is 1e-304 or 1e304."""
    bounded = min(max(x, _LOWEST), _HIGHEST)
    rounded = bounded * _PER_LN2 + _ROUNDING
    n = rounded - _ROUNDING
    r = (bounded - n * _LN2_HIGH) - n * _LN2_LOW
    series = 1.0 + r * (1.0 + r * (1.0 / 2 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120 + r * (1.0 / 720 + r * (
        1.0 / 5040 + r * (1.0 / 40320 + r * (1.0 / 362880 + r * (1.0 / 3628800 + r * (
            1.0 / 39916800 + r * (1.0 / 479001600))))))))))))  # fmt: skip
    return series * _as_float((_as_bits(rounded) + _BIAS) << _MANTISSA_BITS)


@njit
def logarithm(x: float) -> float:
    """Natural logarithm of a number above zero, to 1e-15 beside its rounding.

    ln x = n ln 2 + ln m with m between sqrt(1/2) and sqrt(2): ln m = 2 artanh((m - 1)/(m + 1)) by its series
    (4.1.27), at rounding after eleven terms.
    """
    bits = _as_bits(x)
    n = (bits - _HALF_ROOT_BITS) >> _MANTISSA_BITS
    m = _as_float(bits - (n << _MANTISSA_BITS))
    z = (m - 1.0) / (m + 1.0)
    w = z * z
    series = 2.0 * z * (1.0 + w * (1.0 / 3 + w * (1.0 / 5 + w * (1.0 / 7 + w * (1.0 / 9 + w * (1.0 / 11 + w * (
        1.0 / 13 + w * (1.0 / 15 + w * (1.0 / 17 + w * (1.0 / 19 + w * (1.0 / 21)))))))))))  # fmt: skip
    return n * _LN2_HIGH + (series + n * _LN2_LOW)


@njit
def hyperbolic_tangent(x: float) -> float:
    """Tanh x, to 3e-16."""
    fading = exponential(-2.0 * abs(x))
    return math.copysign((1.0 - fading) / (1.0 + fading), x)


@njit
def cosine_up_to_quarter(a: float) -> float:
    """Cosine of an angle of at most a quarter turn [rad], to 2e-16."""
    b = a * a
    return 1.0 - b * (1.0 / 2 - b * (1.0 / 24 - b * (1.0 / 720 - b * (1.0 / 40320 - b * (1.0 / 3628800 - b * (
        1.0 / 479001600 - b * (1.0 / 87178291200 - b * (1.0 / 20922789888000 - b * (1.0 / 6402373705728000
        - b * (1.0 / 2432902008176640000))))))))))  # fmt: skip


@njit
def _sine_up_to_quarter(a: float) -> float:
    b = a * a
    return a * (1.0 - b * (1.0 / 6 - b * (1.0 / 120 - b * (1.0 / 5040 - b * (1.0 / 362880 - b * (1.0 / 39916800
        - b * (1.0 / 6227020800 - b * (1.0 / 1307674368000 - b * (1.0 / 355687428096000
        - b * (1.0 / 121645100408832000))))))))))  # fmt: skip


@njit
def sine_and_cosine_of_turns(turns: float) -> tuple[float, float]:
    """Sine and cosine of an angle in full turns, to 4e-16 beside the rounding of the number of turns."""
    whole = turns + _ROUNDING
    half = math.pi * (turns - (whole - _ROUNDING))
    s, c = _sine_up_to_quarter(half), cosine_up_to_quarter(half)
    return 2.0 * s * c, 1.0 - 2.0 * s * s
