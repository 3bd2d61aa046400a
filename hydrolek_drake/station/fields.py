"""Single entries of a scenario file, checked and converted to SI."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.rigs.entries import parse_quantity

_FULL_SIGNAL = 100.0  # percent


def required(raw: Mapping[str, Any], key: str, where: str) -> Any:
    """The value of a key that must be there.

    Raises:
        InputError: it is not.
    """
    if key not in raw:
        raise InputError(f"{where}.{key} is missing")
    return raw[key]


def quantity(raw: Any, unit: str, where: str, *, lowest: float = -np.inf, highest: float = np.inf) -> float:
    """A number in SI, or text with a unit such as "20 ms".

    Raises:
        InputError: not a number, another unit, not finite or out of bounds.
    """
    value = parse_quantity(str(raw), Parameter("value", unit, "", lowest=lowest, highest=highest), where)
    if not np.isfinite(value):
        raise InputError(f"{where}: {value} must be finite")
    return value


def signal(raw: Any, where: str) -> float:
    """An operator's signal in percent, "40 %" or 40.

    Raises:
        InputError: not a number or beyond 100 %.
    """
    text = str(raw).strip().removesuffix("%").strip()
    try:
        value = float(text)
    except ValueError:
        raise InputError(f"{where}: '{raw}' is not a signal in percent, such as '40 %' or 40") from None
    if not abs(value) <= _FULL_SIGNAL:
        raise InputError(f"{where}: {value:g} % is impossible; a signal lies between -100 and 100 %")
    return value


def number(raw: Any, where: str, *, lowest: int, highest: int | None = None) -> int:
    """A whole number.

    Raises:
        InputError: anything else, less than `lowest` or more than `highest`.
    """
    if isinstance(raw, bool) or not isinstance(raw, int) or raw < lowest:
        raise InputError(f"{where}: '{raw}' must be a whole number, {lowest} or more")
    if highest is not None and raw > highest:
        raise InputError(f"{where}: {raw} must be a whole number of at most {highest}")
    return raw
