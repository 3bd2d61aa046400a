"""No valve opens on bad data: what every controller is wrapped in."""

from dataclasses import dataclass
from functools import cache
from math import isfinite
from typing import Any

import numpy as np

from hydrolek_drake.control.laws.law import Array, ControlLaw
from hydrolek_drake.yaml_files import package_yaml

HEALTHY, STUCK = 0.0, 1.0
_ACTIVE, _FAULT, _LAST, _SAME, _COUNT, _FROM, _DIRECTION, _VOLTAGE = range(8)
_SIZE = 8


@cache
def guard_data() -> dict[str, Any]:
    """Content of `guard.yaml`."""
    return package_yaml(__package__, "guard.yaml")


@dataclass(frozen=True)
class GuardedLaw:
    """A control law that closes the valve when set point or measurement cannot be trusted.

    - Set point not a number: it was withdrawn. The valve closes, faults are forgotten.
    - Measurement not a number, or further outside the joint's range than `plausible_margin_deg`: lost. The
      valve closes until it is back.
    - Stuck, or a supply or cylinder that does not answer: the valve has been commanded beyond
      `pushing_V` in one direction for `pushing_samples`, and the reading has not moved
      `least_travel_deg` that way. The valve closes until the set point is withdrawn and given again.
    - Frozen: `frozen_samples` identical readings of a sensor that has noise. The valve closes until the
      reading changes. Zero switches this off, for models without noise.

    When control begins, or begins again, the law starts from `initial`, so that no voltage jumps: zero error
    gives zero output. Set points beyond the joint's range are taken as its end.

    Attributes:
        law: what is guarded.
        lower_deg: end of the joint's range.
        upper_deg: the other end.
        pushing_V: voltages below zero and above zero beyond which the joint must move.
        pushing_samples: how long it may take.
        least_travel_deg: what counts as movement.
        plausible_margin_deg: how far readings may lie outside the range.
        frozen_samples: identical readings in a row that a live sensor never gives; 0 for any number.
        clip_set_point: false for laws whose set point is not an angle.
    """

    law: ControlLaw
    lower_deg: float
    upper_deg: float
    pushing_V: tuple[float, float]
    pushing_samples: int
    least_travel_deg: float
    plausible_margin_deg: float
    frozen_samples: int = 0
    clip_set_point: bool = True

    @property
    def size(self) -> int:
        """The guard's own variables, then the law's."""
        return _SIZE + self.law.size

    def initial(self, measured_deg: float) -> Array:
        """Not yet in control: the law's own `initial` is called at the first sample with good data."""
        state = np.zeros(self.size)
        state[_LAST] = measured_deg
        return state

    def faulty(self, state: Array) -> bool:
        """Whether a stuck reading, or a joint that does not answer, has closed the valve."""
        return bool(state[_FAULT] == STUCK)

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; bad data give output 0 and voltage 0."""
        own = state[:_SIZE].copy()
        if not isfinite(set_point_deg):
            own[_FAULT] = HEALTHY
        readable = (
            isfinite(measured_deg)
            and self.lower_deg - self.plausible_margin_deg
            <= measured_deg
            <= self.upper_deg + self.plausible_margin_deg
        )
        if readable:
            self._watch(own, measured_deg)
        frozen = self.frozen_samples > 0 and own[_SAME] >= self.frozen_samples
        if not (readable and isfinite(set_point_deg)) or frozen or own[_FAULT] == STUCK:
            own[_ACTIVE] = own[_VOLTAGE] = 0.0
            return np.concatenate([own, np.zeros(self.law.size)]), 0.0, 0.0
        wanted = min(max(set_point_deg, self.lower_deg), self.upper_deg)
        if not self.clip_set_point:
            wanted = set_point_deg
        inner = state[_SIZE:] if own[_ACTIVE] else self.law.initial(measured_deg)
        inner, output, voltage = self.law.step(inner, wanted, measured_deg)
        own[_ACTIVE], own[_VOLTAGE] = 1.0, voltage
        return np.concatenate([own, inner]), output, voltage

    def _watch(self, own: Array, measured_deg: float) -> None:
        """Count identical readings, and samples of pushing without movement, after the last voltage."""
        own[_SAME] = own[_SAME] + 1.0 if measured_deg == own[_LAST] else 0.0
        own[_LAST] = measured_deg
        low, high = self.pushing_V
        direction = float(own[_VOLTAGE] > high) - float(own[_VOLTAGE] < low)
        moved = (measured_deg - own[_FROM]) * direction
        if direction == 0.0 or direction != own[_DIRECTION] or moved >= self.least_travel_deg:
            own[_DIRECTION], own[_FROM], own[_COUNT] = direction, measured_deg, 0.0
            return
        own[_COUNT] += 1.0
        if own[_COUNT] >= self.pushing_samples:
            own[_FAULT] = STUCK


def guarded(
    law: ControlLaw,
    range_deg: tuple[float, float],
    dead_zone_V: tuple[float, float],
    sample_s: float,
    *,
    noisy: bool,
    clip_set_point: bool = True,
) -> GuardedLaw:
    """A law with the guard of `guard.yaml`.

    Args:
        law: to be guarded.
        range_deg: lower and upper end of the joint's range.
        dead_zone_V: lower and upper edge of the valve's dead-zone.
        sample_s: of the law.
        noisy: whether the sensor has noise, so that identical readings mean a dead one.
        clip_set_point: false for laws whose set point is not an angle.
    """
    data = {key: float(item["value"]) for key, item in guard_data().items()}
    factor = data["pushing_factor"]
    return GuardedLaw(
        law=law,
        lower_deg=range_deg[0],
        upper_deg=range_deg[1],
        pushing_V=(factor * dead_zone_V[0], factor * dead_zone_V[1]),
        pushing_samples=round(data["pushing_time"] / sample_s),
        least_travel_deg=data["least_travel"],
        plausible_margin_deg=data["plausible_margin"],
        frozen_samples=round(data["frozen_samples"]) if noisy else 0,
        clip_set_point=clip_set_point,
    )
