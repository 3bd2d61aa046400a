"""What the console shows of a machine beyond its angles: voltages, pressures, potentiometers; as one line of text."""

import json
import math
from dataclasses import dataclass, field, fields
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.link.messages import BUSY, ERROR, decode_answer

Array = NDArray[np.float64]

_Joints = Annotated[list[float | None], Field(min_length=14, max_length=14)]
_Arms = Annotated[list[float | None], Field(min_length=2, max_length=2)]
_Pose = Annotated[list[float | None], Field(min_length=6, max_length=6)]


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
        content = {each.name: _plain(getattr(self, each.name)) for each in fields(self)}
        return (json.dumps(content) + "\n").encode("ascii")


class _Line(BaseModel):
    """What a line of signals must hold; null stands for what is not finite."""

    model_config = ConfigDict(strict=True, extra="ignore", allow_inf_nan=False)

    time: float
    supply_pressure: float | None
    pace: float | None
    voltage: _Joints
    pressure_a: _Joints
    pressure_b: _Joints
    potentiometer: _Joints
    grip: _Arms
    pipe_place: _Pose


def signals_from_line(line: bytes) -> Signals | None:
    """Read `Signals.to_line`; None for an empty object, which says that the machine has no signals.

    Raises:
        InputError: Anything else.
    """
    if line.strip() == b"{}":
        return None
    if line.startswith((BUSY.encode(), ERROR.encode())):
        decode_answer(line)  # refused, with its reason
    try:
        content = _Line.model_validate_json(line)
    except ValidationError as error:
        first = error.errors(include_url=False, include_context=False, include_input=False)[0]
        place = ".".join(str(part) for part in first["loc"])
        raise InputError(
            f"link: {line[:60]!r} is no line of signals: {place + ': ' if place else ''}{first['msg']}"
        ) from None
    values: dict[str, Any] = {}
    for name, value in content:
        values[name] = (
            np.array([_number(each) for each in value]) if isinstance(value, list) else _number(value)
        )
    return Signals(**values)


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
