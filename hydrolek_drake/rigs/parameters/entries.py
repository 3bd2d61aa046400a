"""One parameter as a rig file states it, checked and converted to SI."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.units import si_factor

_NUMBER = re.compile(r"[-+]?(?:(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|nan|inf)", re.IGNORECASE)
_KEYS = ("value", "unit", "source", "range", "scale", "same_as", "note")


@dataclass(frozen=True)
class Entry:
    """A parameter of a rig.

    Attributes:
        value: in SI.
        unit: the SI unit.
        source: where the number comes from.
        range: admissible values in a fit (SI), or None if it is not fitted.
        scale: "log" or "linear": how a fit searches the range.
        same_as: name of the parameter of the same stage whose value it takes, or None.
    """

    value: float
    unit: str
    source: str
    range: tuple[float, float] | None = None
    scale: str = "linear"
    same_as: str | None = None


def parse_entry(raw: Any, parameter: Parameter, where: str) -> Entry:
    """Check one parameter's mapping and convert it to SI.

    Args:
        raw: what stands in the file.
        parameter: what is expected.
        where: file and key, for the error.

    Raises:
        InputError: not a mapping, unknown key, wrong unit, not a number, out of bounds, empty range.
    """
    if not isinstance(raw, Mapping):
        raise InputError(
            f"{where}: '{raw}' is not a parameter; write {{value: ..., unit: {parameter.unit}, source: ...}}"
        )
    for key in raw:
        if key not in _KEYS:
            raise InputError(f"{where}: unknown key '{key}'; a parameter has {', '.join(_KEYS)}")
    if "same_as" in raw:
        return Entry(float("nan"), parameter.unit, str(raw.get("source", "")), same_as=str(raw["same_as"]))
    for key in ("value", "unit", "source"):
        if key not in raw:
            raise InputError(
                f"{where}: '{key}' is missing; write {{value: ..., unit: {parameter.unit}, source: ...}}"
            )
    factor, unit = _factor(str(raw["unit"]), parameter, where)
    value = _in_si(raw["value"], factor, where)
    if not parameter.lowest <= value <= parameter.highest:
        raise InputError(
            f"{where}: value {value:g} {unit} is impossible; "
            f"it must lie between {parameter.lowest:g} and {parameter.highest:g}"
        )
    if parameter.positive and not value > 0.0:
        raise InputError(f"{where}: value {value:g} {unit} is impossible; it must be above zero")
    limits = None
    if "range" in raw:
        pair = raw["range"]
        if not isinstance(pair, list) or len(pair) != 2:
            raise InputError(f"{where}: range '{pair}' must be a list of two numbers, [lowest, highest]")
        low, high = (_in_si(v, factor, where) for v in pair)
        if not low < high:
            raise InputError(
                f"{where}: range {pair} is empty; the first number must be smaller than the second"
            )
        limits = (low, high)
    scale = str(raw.get("scale", "linear"))
    if scale not in ("linear", "log"):
        raise InputError(f"{where}: scale '{scale}' is unknown; use linear or log")
    if scale == "log" and limits is not None and limits[0] <= 0.0:
        raise InputError(f"{where}: a log scale needs a range above zero, not {raw['range']}")
    return Entry(value, unit, str(raw["source"]), limits, scale)


def written_entry(entry: Entry) -> dict[str, Any]:
    """A parameter as a rig file states it."""
    if entry.same_as is not None:
        return {"same_as": entry.same_as}
    written: dict[str, Any] = {
        "value": float(entry.value),
        "unit": entry.unit.split("|")[0],
        "source": entry.source,
    }
    if entry.range is not None:
        written["range"] = [float(v) for v in entry.range]
        written["scale"] = entry.scale
    return written


def parse_quantity(text: str, parameter: Parameter, where: str) -> float:
    """A value given as text, "12e6" in SI or "12 MPa" with its unit, in SI.

    Raises:
        InputError: not a number, wrong unit or out of bounds.
    """
    found = _NUMBER.match(text.strip())
    if found is None:
        raise InputError(
            f"{where}: '{text}' is not a number with a unit, such as '12 MPa' or '12e6'"
        ) from None
    unit = text.strip()[found.end() :].strip() or parameter.unit.split("|")[0]
    raw = {"value": float(found.group()), "unit": unit, "source": "command line"}
    return parse_entry(raw, parameter, where).value


def _factor(unit: str, parameter: Parameter, where: str) -> tuple[float, str]:
    problem: InputError | None = None
    for choice in parameter.unit.split("|"):
        try:
            return si_factor(unit, choice), choice
        except InputError as error:
            problem = error
    raise InputError(f"{where}: {problem}")


def _in_si(raw: Any, factor: float, where: str) -> float:
    value = _number(raw, where) * factor
    if abs(value) == float("inf"):
        raise InputError(f"{where}: '{raw}' is too large a number in SI")
    return value


def _number(raw: Any, where: str) -> float:
    if isinstance(raw, bool) or not isinstance(raw, (int, float, str)):
        raise InputError(f"{where}: '{raw}' is not a number")
    try:
        value = float(raw)
    except (ValueError, OverflowError):
        raise InputError(f"{where}: '{raw}' is not a number") from None
    if value != value:
        raise InputError(f"{where}: the value is not a number (NaN)")
    if abs(value) == float("inf"):
        raise InputError(f"{where}: '{raw}' is not a finite number")
    return value
