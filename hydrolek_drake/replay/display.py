"""Units in which people read a signal."""

from hydrolek_drake.units import si_factor

_READ_AS = {"rad": "deg", "m": "mm", "Pa": "MPa"}


def display_unit(unit: str) -> str:
    """The unit that people use for an SI unit."""
    return _READ_AS.get(unit, unit)


def display_factor(unit: str) -> float:
    """Number in the display unit = factor times number in SI."""
    return si_factor(unit, display_unit(unit))


def three_digits(value: float) -> str:
    """A number to three digits, in full up to a million: 1260, not 1.26e+03."""
    return f"{float(f'{value:.3g}'):g}"


def ratio(value: float) -> str:
    """A ratio to three digits, zeros too, so that ratios stand below each other: 1.00, 26.3, 1260."""
    return f"{value:#.3g}" if abs(value) < 99.95 else three_digits(value)


def shown(value: float, unit: str) -> str:
    """A value given in SI, with three digits and the unit that people use; a mere number without one."""
    number = three_digits(value * display_factor(unit))
    return number if unit == "1" else f"{number} {display_unit(unit)}"
