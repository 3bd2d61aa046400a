"""Exponential and hyperbolic tangent in plain arithmetic, for loops over machines in lanes.

The mathematical library's functions are calls, of which no compiler makes vector instructions. e^x = 2^n e^r with n the
nearest whole number to x / ln 2 and |r| <= ln 2 / 2, for which the series (Abramowitz, Stegun, Handbook of Mathematical
Functions, 4.2.1) is at rounding after thirteen terms; tanh x = (1 - e^(-2x)) / (1 + e^(-2x)) (4.5.26).
"""

import math
from typing import Any

from numba import types
from numba.extending import intrinsic

from hydrolek_drake.compiling import njit

_PER_LN2 = 1.0 / math.log(2.0)
_LN2_HIGH = 0.693147180369123816490  # ln 2 in two parts: the product of this one with a whole number is exact
_LN2_LOW = 1.90821492927058770002e-10
_LOWEST, _HIGHEST = -700.0, 700.0  # beyond, e^x is no normal number
_ROUNDING = 1.5 * 2.0**52  # added to a number, it leaves the nearest whole one in the lowest bits
_BIAS, _MANTISSA_BITS = 1023, 52  # of a float64


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
def hyperbolic_tangent(x: float) -> float:
    """Tanh x, to 3e-16."""
    fading = exponential(-2.0 * abs(x))
    return math.copysign((1.0 - fading) / (1.0 + fading), x)
