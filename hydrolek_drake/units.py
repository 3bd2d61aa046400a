"""Conversion of values with a unit to SI, for everything that comes in from outside."""

import math
import re
from functools import cache
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.unit_memory import remember, remembered

_LONGEST = 60
_TOKEN = re.compile(
    r"(?P<power>(?:\^|\*\*)[-+]?\d(?:\.\d{1,2})?(?![\w.]))"
    r"|(?P<name>[^\W\d]\w*|[%‰°])|(?P<one>1(?![\w.]))|(?P<sign>[ */()·])"
)
"""What units are written with. Pint would also calculate: it works at `m^(9^9^9)` until the memory is full."""

_OF_AN_ANGLE = re.compile(
    r"(?<![A-Za-z])(m?rad|radians?|deg|degrees?|rev|revolutions?|turns?|rpm|°)(?![A-Za-z])|°"
)
_ANGULAR = {"rad": "deg or rad", "rad/s": "rpm, deg/s or rad/s", "m^3/rad": "cm^3/rev or m^3/rad"}
_NOT_ANGULAR = ("m", "m/s", "m^3", "m^3/s")


@cache
def _registry() -> Any:
    import pint  # takes a while to load, and SI-only input never needs it

    registry: Any = pint.UnitRegistry()
    registry.define("@alias turn = rev")  # as pumps and motors are specified: cm^3/rev
    return registry


@cache
def si_factor(unit: str, si_unit: str) -> float:
    """Factor from `unit` to `si_unit`, for example 1e6 from "MPa" to "Pa".

    Units are written as in rig files ("m^3/(s Pa)", "deg/s") or as in column names ("deg_per_s").

    Raises:
        InputError: `unit` is unknown, measures something else than `si_unit`, or has a zero of its own as degC has.
    """
    if unit == si_unit:
        return 1.0
    wanted = f"use {si_unit or 'no unit (1)'}"
    if not unit:
        raise InputError(f"a unit is missing; {wanted}")
    if not _is_plain(unit):
        raise InputError(f"unit '{unit[:_LONGEST]}' is not known; {wanted}")
    of_an_angle = _OF_AN_ANGLE.search(_spelled(unit)) is not None
    if si_unit in _ANGULAR and not of_an_angle:  # Pint takes 1 for a radian: 1/min for rad/min
        raise InputError(f"unit '{unit}' does not say of which angle; use {_ANGULAR[si_unit]}")
    if si_unit in _NOT_ANGULAR and of_an_angle:
        raise InputError(f"unit '{unit}' is per angle; {wanted}")
    known = remembered(unit, si_unit)
    if known is not None:
        return known
    import pint

    registry = _registry()
    try:
        zero, one = (
            float(registry.Quantity(value, _spelled(unit)).to(_spelled(si_unit)).magnitude)
            for value in (0.0, 1.0)
        )
    except pint.DimensionalityError:
        raise InputError(f"unit '{unit}' does not measure what is wanted here; {wanted}") from None
    except Exception:
        raise InputError(f"unit '{unit}' is not known; {wanted}") from None
    if zero != 0.0 or not 0.0 < one < math.inf:
        raise InputError(f"unit '{unit}' is not a multiple of another one; {wanted}")
    remember(unit, si_unit, one)
    return one


def _is_plain(unit: str) -> bool:
    """Whether a unit consists of names, products, quotients and single powers."""
    if len(unit) > _LONGEST:
        return False
    place, last = 0, ""
    while place < len(unit):
        found = _TOKEN.match(unit, place)
        if found is None or (found.lastgroup == last == "power"):
            return False
        place, last = found.end(), str(found.lastgroup)
    return True


def _spelled(unit: str) -> str:
    """Pint's spelling: a blank between two units is a product, `_per_` a quotient."""
    return unit.replace("_per_", "/").replace("^", "**").replace(" ", "*") or "dimensionless"
