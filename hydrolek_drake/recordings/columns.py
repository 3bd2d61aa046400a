"""Names of columns: which signal a column holds and the factor to SI."""

import re
from collections.abc import Mapping
from typing import NamedTuple

from hydrolek_drake.errors import InputError
from hydrolek_drake.units import si_factor

TIME = "time"
"""Key of the time column; every other key is `<joint>.<quantity>`."""

IGNORE = "ignore"
"""What a mapping gives to a column that shall not be used although its name would be understood."""

QUANTITIES: dict[str, tuple[str, ...]] = {
    "command": ("V", "A", "m", "1"),
    "angle": ("rad",),
    "rate": ("rad/s",),
    "position": ("m",),
    "velocity": ("m/s",),
    "pot": ("V", "1"),
    "current": ("A",),
    "spool": ("m",),
    "pressure": ("Pa",),
    "pressure_a": ("Pa",),
    "pressure_b": ("Pa",),
    "force": ("N",),
    "effort": ("N m", "N"),
    "reference": ("rad", "m", "V", "Pa", "N"),
}
"""SI units that each quantity may have; the first is meant where none is stated."""

HELD_QUANTITIES = frozenset({"command", "reference"})
"""Quantities that a controller sets and holds until it sets the next value."""

_JOINT = re.compile(r"[A-Za-z_][\w-]*")
_LONGEST_FIRST = sorted(QUANTITIES, key=len, reverse=True)
_SPELLINGS = {"Nm": "N m", "kNm": "kN m", "unitless": "1"}
_ANGLE_UNITS = re.compile(r"(rad|mrad|urad|radians?|deg|degrees?|arcmin|arcsec|turns?|rev|revolutions?)")
_SPEED_UNITS = re.compile(rf"{_ANGLE_UNITS.pattern}(_per_|/).+|rpm")
_FRACTION_UNITS = re.compile(r"1|percent")


class ColumnName(NamedTuple):
    """A column name that was understood.

    Attributes:
        key: `time` or `<joint>.<quantity>`.
        factor: SI value = factor times the value in the column.
        unit: The SI unit.
    """

    key: str
    factor: float
    unit: str


def parse_column(name: str) -> ColumnName | None:
    """Read a column name such as `right_j2.angle_deg`, `supply.pressure_MPa` or `time_ms`.

    Returns:
        None if this is not a name of the form `time_<unit>` or `<joint>.<quantity>_<unit>`.

    Raises:
        InputError: Joint and quantity are understood, but the unit is missing, unknown or of another kind.
    """
    if name.startswith(f"{TIME}_"):
        return _parse_time(name)
    joint, dot, rest = name.partition(".")
    if not dot or not _JOINT.fullmatch(joint):
        return None
    for quantity in _LONGEST_FIRST:
        if rest == quantity or rest.startswith(f"{quantity}_"):
            unit, factor = _unit_of(name, quantity, rest[len(quantity) + 1 :])
            return ColumnName(f"{joint}.{quantity}", factor, unit)
    return None


def quantity_of(key: str) -> str:
    """The quantity in a signal key: `pressure_a` of `right_j2.pressure_a`."""
    return key.rpartition(".")[2]


def default_unit(key: str) -> str | None:
    """SI unit that the quantity of a signal key has unless stated otherwise; None if it is unknown."""
    units = QUANTITIES.get(quantity_of(key))
    return units[0] if units else None


def column_name(key: str, unit: str) -> str:
    """Column name for a signal key with its unit: `joint.rate` in `rad/s` is `joint.rate_rad_per_s`."""
    spelled = next((short for short, long in _SPELLINGS.items() if long == unit and unit != "1"), unit)
    return f"{key}_{spelled.replace('/', '_per_').replace(' ', '_')}"


def check_mapping(columns: Mapping[str, str]) -> None:
    """Check that every column is mapped to a name that carries signal and unit.

    Raises:
        InputError: A mapped-to name cannot be understood.
    """
    for name, target in columns.items():
        if target == IGNORE:
            continue
        try:
            understood = parse_column(target)
        except InputError as error:
            raise InputError(f"columns: {name!r} is mapped to {error}") from None
        if understood is None:
            raise InputError(
                f"columns: {name!r} is mapped to {target!r}; write time_<unit>, <joint>.<quantity>_<unit> "
                f"or {IGNORE}, with quantity one of {', '.join(QUANTITIES)}"
            )


def _parse_time(name: str) -> ColumnName | None:
    """A time column; an unknown unit makes it just another column, such as `time_of_day`."""
    try:
        return ColumnName(TIME, si_factor(name.removeprefix(f"{TIME}_"), "s"), "s")
    except InputError:
        return None


def _unit_of(name: str, quantity: str, written: str) -> tuple[str, float]:
    choices = QUANTITIES[quantity]
    example = column_name(name.partition(".")[0] + "." + quantity, choices[0])
    if not written:
        raise InputError(f"column {name!r} has no unit; write for example {example}")
    spelled = _SPELLINGS.get(written, written)
    for unit in choices:
        if not _same_kind(spelled, unit):
            continue
        try:
            return unit, si_factor(spelled, "" if unit == "1" and spelled != "1" else unit)
        except InputError:
            continue
    raise InputError(
        f"column {name!r} has the unit {written!r}, which does not measure {quantity}; "
        f"write for example {example}"
    )


def _same_kind(written: str, unit: str) -> bool:
    """Keep angles, frequencies and fractions apart, which dimensional analysis takes for one and the same."""
    kinds = {"rad": _ANGLE_UNITS, "rad/s": _SPEED_UNITS, "1": _FRACTION_UNITS}
    return kinds[unit].fullmatch(written) is not None if unit in kinds else True
