"""Conversion of values with a unit to SI, for everything that comes in from outside."""

from functools import cache
from typing import Any

from hydrolek_drake.errors import InputError


@cache
def _registry() -> Any:
    import pint  # takes a while to load, and SI-only input never needs it

    return pint.UnitRegistry()


@cache
def si_factor(unit: str, si_unit: str) -> float:
    """Factor from `unit` to `si_unit`, for example 1e6 from "MPa" to "Pa".

    Units are written as in rig files ("m^3/(s Pa)", "deg/s") or as in column names ("deg_per_s").

    Raises:
        InputError: `unit` is unknown or measures something else than `si_unit`.
    """
    if unit == si_unit:
        return 1.0
    wanted = f"use {si_unit or 'no unit (1)'}"
    if not unit:
        raise InputError(f"a unit is missing; {wanted}")
    import pint

    registry = _registry()
    try:
        return float(registry.Quantity(1.0, _spelled(unit)).to(_spelled(si_unit)).magnitude)
    except pint.DimensionalityError:
        raise InputError(f"unit '{unit}' does not measure what is wanted here; {wanted}") from None
    except Exception:
        raise InputError(f"unit '{unit}' is not known; {wanted}") from None


def _spelled(unit: str) -> str:
    """Pint's spelling: a blank between two units is a product, `_per_` a quotient."""
    return unit.replace("_per_", "/").replace("^", "**").replace(" ", "*") or "dimensionless"
