"""What the console shows of a machine beyond its angles: voltages, pressures, potentiometers; as one line of text."""

import json
import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError

Array = NDArray[np.float64]

_VECTORS = {
    "voltage": 14,
    "pressure_a": 14,
    "pressure_b": 14,
    "potentiometer": 14,
    "grip": 2,
    "pipe_place": 6,
}
_SCALARS = ("time", "supply_pressure", "pace")


@dataclass(frozen=True)
class Signals:
    """One sample; vectors are of joints `right_j1` ... `left_j7`, shape (14,), if nothing else is said.

    Attributes:
        time: Of the plant in s.
        voltage: To the amplifiers in V.
        pressure_a: Of the chambers in Pa.
        pressure_b: Of the chambers in Pa.
        potentiometer: As read by the control computer in V; NaN for a joint without one.
        supply_pressure: In Pa.
        grip: Force on the moving finger of the right and the left gripper in N, shape (2,).
        pipe_place: Middle of the simulated pipe in m and its axis, world frame, shape (6,); NaN without one.
        pace: Simulated seconds a second, lately; below 1 the computer is too slow.
    """

    time: float
    voltage: Array
    pressure_a: Array
    pressure_b: Array
    potentiometer: Array
    supply_pressure: float
    grip: Array
    pipe_place: Array = field(default_factory=lambda: np.full(6, np.nan))
    pace: float = 1.0

    def to_line(self) -> bytes:
        """One line of JSON in SI units; what is not finite is null."""
        content = {name: _plain(getattr(self, name)) for name in (*_SCALARS, *_VECTORS)}
        return (json.dumps(content) + "\n").encode("ascii")


def signals_from_line(line: bytes) -> Signals | None:
    """Read `Signals.to_line`; None for an empty object, which says that the machine has no signals.

    Raises:
        InputError: Anything else.
    """
    try:
        content = json.loads(line)
        if content == {}:
            return None
        vectors = {name: np.array([_number(value) for value in content[name]]) for name in _VECTORS}
        scalars = {name: _number(content[name]) for name in _SCALARS}
    except (ValueError, KeyError, TypeError):
        raise InputError(f"link: {line[:60]!r} is no line of signals") from None
    for name, values in vectors.items():
        if values.shape != (_VECTORS[name],):
            raise InputError(f"link: signals: {name} has {len(values)} values; {_VECTORS[name]} are needed")
    content_si: dict[str, Any] = {**scalars, **vectors}
    return Signals(**content_si)


def shown(signals: Signals) -> dict[str, Any]:
    """The same for the page, in V and MPa, rounded to what a chart can show; what is not finite is null."""
    rounded = {
        "time": round(signals.time, 3),
        "pace": round(signals.pace, 2),
        "supply_MPa": round(signals.supply_pressure / 1e6, 3),
        "voltage_V": np.round(signals.voltage, 3),
        "pressure_a_MPa": np.round(signals.pressure_a / 1e6, 3),
        "pressure_b_MPa": np.round(signals.pressure_b / 1e6, 3),
        "grip_N": np.round(signals.grip, 1),
        "potentiometer_V": np.round(signals.potentiometer, 3),
    }
    return {name: _plain(value) for name, value in rounded.items()}


def _plain(value: Any) -> Any:
    if np.ndim(value):
        return [_plain(each) for each in value]
    return float(f"{value:.7g}") if math.isfinite(value) else None


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
