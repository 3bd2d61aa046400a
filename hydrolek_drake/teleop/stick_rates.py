"""What an operator knows of how fast joints move at each deflection of the joystick."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.catalogue import JointSetting, chosen
from hydrolek_drake.control.laws.rate_map import map_from_model, rate_at
from hydrolek_drake.control.thesis_gains import signal_limit
from hydrolek_drake.teleop.operator_model import operator_entries

Array = NDArray[np.float64]


@dataclass(frozen=True)
class StickRates:
    """What an operator knows of the joints.

    Attributes:
        percent: Deflections that the stick is held at, shape (k,).
        speeds: Speed in rad/s towards falling and rising angles at each, shape (n, 2, k).
        dead_time: From the stick to the joint's motion in s, shape (n,).
    """

    percent: Array
    speeds: Array
    dead_time: Array

    def smallest(
        self, joint: int, sign: float, wanted: float, most: float, beyond: float = 0.0
    ) -> tuple[float, float]:
        """Smallest deflection up to `most` percent that gives at least the wanted speed, and its speed.

        Args:
            joint: From 0.
            sign: Direction.
            wanted: In rad/s.
            most: In percent.
            beyond: Deflections up to this many percent are known not to move the joint.
        """
        side = self.speeds[joint, int(sign > 0.0)]
        usable = (self.percent <= most) & (side > 0.0)
        usable &= (self.percent > beyond) | (self.percent == self.percent[usable][-1])
        enough = np.flatnonzero(usable & (side >= wanted))
        index = int(enough[0] if len(enough) else np.flatnonzero(usable)[-1])
        return float(self.percent[index]), float(side[index])


def stick_rates(settings: Sequence[JointSetting]) -> StickRates:
    """From the rate maps of joints, through the joystick's scaling."""
    step, idle = operator_entries("hand")["stick_step"], float(chosen()["joystick"]["idle"]["value"])
    percent = np.arange(idle + step, signal_limit() + 0.5 * step, step)
    maps = [each.rates or map_from_model(each.model) for each in settings]
    speeds = [
        [
            [rate_at(rates.side(sign), abs(each.scaling.voltage(sign * value))) for value in percent]
            for sign in (-1.0, 1.0)
        ]
        for each, rates in zip(settings, maps, strict=True)
    ]
    return StickRates(percent, np.radians(speeds), np.array([each.dead_time_s for each in maps]))
