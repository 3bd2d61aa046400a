"""Parameters as an engineer writes them: to three digits, or to as many as their interval bears."""

import math

from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.replay.display import display_factor, display_unit, shown, three_digits

FULL = range(-3, 6)
"""Powers of ten of numbers that are written in full: 0.00123 and 126000, but 1.23e-04 and 1.26e+06."""

MOST_DIGITS = 7
"""Of a number whose interval is narrower than anyone reads."""


def quantity(value: float, unit: str) -> str:
    """A parameter given in SI, to three digits; of alternative units, behind a bar, the first."""
    return shown(value, unit.partition("|")[0])


def with_interval(known: Interval, unit: str) -> tuple[str, str, str]:
    """A fitted value, the lower end of its interval and the upper one, in the unit that people use.

    All three are rounded alike, so that two digits of half the interval's width are seen; a value whose interval has
    no width is told to three digits. The unit is written behind the first and the last.

    Args:
        known: in SI.
        unit: SI unit, alternatives behind a bar.
    """
    main = unit.partition("|")[0]
    factor = display_factor(main)
    value, low, high = (factor * v for v in (known.value, known.low, known.high))
    largest = max(abs(value), abs(low), abs(high))
    half = 0.5 * abs(high - low)
    if not 0.0 < half < math.inf:
        texts = [three_digits(v) for v in (value, low, high)]
    else:
        leading = _power(abs(value) if 10.0 * abs(value) > largest else largest)
        decimals = min(1 - _power(half), MOST_DIGITS - 1 - leading)
        texts = [_rounded(v, decimals, leading) for v in (value, low, high)]
    return f"{texts[0]}{_written(main)}", texts[1], f"{texts[2]}{_written(main)}"


def _written(unit: str) -> str:
    return "" if unit == "1" else f" {display_unit(unit)}"


def _power(value: float) -> int:
    return math.floor(math.log10(value))


def _rounded(value: float, decimals: int, leading: int) -> str:
    """A number to so many decimals; with this power of ten where it is no everyday one."""
    if leading in FULL:
        return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"
    return f"{round(value * 10.0**-leading, decimals + leading) + 0.0:.{max(decimals + leading, 0)}f}e{leading:+03d}"
