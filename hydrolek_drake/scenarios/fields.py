"""Single entries of a scenario file, checked and converted to SI."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.parameters.entries import parse_quantity

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


def joints_of(raw: Any, rig: Rig, where: str) -> Mapping[str, Any]:
    """A mapping from moving joints of a rig to what they are given.

    Raises:
        InputError: no mapping, or another joint.
    """
    if not isinstance(raw, Mapping):
        raise InputError(
            f"{where} must be a mapping from joint to command; joints are {', '.join(rig.joints)}"
        )
    for joint in raw:
        if joint not in rig.joints:
            raise InputError(
                f"{where}.{joint}: rig {rig.name} has no moving joint of that name; choose {', '.join(rig.joints)}"
            )
    return raw


def steps(
    raw: Any, where: str, example: str, value: Callable[[Any, str], float]
) -> tuple[tuple[float, float], ...]:
    """A list of [time, value]: times [s] that increase, and what each value means.

    Args:
        raw: as written.
        where: file and key, for errors.
        example: of a value, for errors.
        value: entry and its place -> number.

    Raises:
        InputError: anything else.
    """
    if not isinstance(raw, list) or not raw:
        raise InputError(
            f"{where}: '{raw}' must be a list of [time, value], such as [[0.5 s, {example}], [2 s, 0]]"
        )
    rows: list[tuple[float, float]] = []
    for index, pair in enumerate(raw):
        if not isinstance(pair, list) or len(pair) != 2:
            raise InputError(f"{where}[{index}]: '{pair}' must be [time, value], such as [0.5 s, {example}]")
        time = quantity(pair[0], "s", f"{where}[{index}]", lowest=0.0)
        if rows and time <= rows[-1][0]:
            raise InputError(f"{where}[{index}]: time {time:g} s does not come after {rows[-1][0]:g} s")
        rows.append((time, value(pair[1], f"{where}[{index}]")))
    return tuple(rows)
