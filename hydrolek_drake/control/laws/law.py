"""What every control law is: a difference equation with a flat state."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class InputElement(Protocol):
    """What stands between a linear controller's output and the valve: none, a scaling, an inverse dead-zone."""

    def voltage(self, output: float) -> float:
        """Voltage for a controller output."""
        ...

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest output that still changes the voltage."""
        ...


class ControlLaw(Protocol):
    """One joint's controller, sampled; pure, so that every execution runs the same arithmetic."""

    @property
    def size(self) -> int:
        """Number of state variables."""
        ...

    def initial(self, measured_deg: float) -> Array:
        """State with which zero error gives zero output: where control takes over without a bump.

        Args:
            measured_deg: the joint's angle when control begins.
        """
        ...

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """One sample.

        Args:
            state: from `initial` or the last `step`; not changed.
            set_point_deg: wanted angle.
            measured_deg: measured angle.

        Returns:
            Next state, controller output (in the unit of the input element), voltage [V].
        """
        ...


class WithoutState:
    """What a `ControlLaw` says of its state that has none."""

    @property
    def size(self) -> int:
        """No state."""
        return 0

    def initial(self, measured_deg: float) -> Array:
        """No state."""
        return np.zeros(0)


def clipped(value: float, limits: tuple[float, float]) -> float:
    """`value` within limits."""
    return min(max(value, limits[0]), limits[1])
