"""The full hydraulic plant as a machine behind the link."""

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms
from hydrolek_drake.teleop.link.authority import LinkOrder
from hydrolek_drake.teleop.link.signals import Signals

Array = NDArray[np.float64]


class HydraulicEnd:
    """`HydraulicArms` behind the link (see `adapter.Arms`).

    Args:
        arms: The machine.

    Attributes:
        period: Seconds between two samples.
    """

    def __init__(self, arms: HydraulicArms) -> None:
        self.period = sample_s()
        self._arms = arms

    def advance(self, order: LinkOrder) -> None:
        """Simulate one control sample."""
        if not order.valves_open:
            self._arms.advance()
        elif order.deflection is not None:
            self._arms.advance(deflection=order.deflection)
        else:
            self._arms.advance(order.desired)

    def measured(self) -> Array:
        """As the sensors read them."""
        return self._arms.measured()

    def signals(self) -> Signals:
        """Voltages, pressures and grip."""
        return self._arms.signals()

    def close(self) -> None:
        """Nothing is held."""
