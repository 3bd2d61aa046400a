"""Units in which people read a signal."""

from hydrolek_drake.units import si_factor

_READ_AS = {"rad": "deg", "m": "mm", "Pa": "MPa"}


def display_unit(unit: str) -> str:
    """The unit that people use for an SI unit."""
    return _READ_AS.get(unit, unit)


def display_factor(unit: str) -> float:
    """Number in the display unit = factor times number in SI."""
    return si_factor(unit, display_unit(unit))


def shown(value: float, unit: str) -> str:
    """A value given in SI, with three digits and the unit that people use."""
    return f"{value * display_factor(unit):.3g} {display_unit(unit)}"
