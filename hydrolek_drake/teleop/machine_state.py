"""What the console shows of the machine."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.teleop.hand import travel
from hydrolek_drake.teleop.link.signals import Signals, shown
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.workcell.pipe import Pipe

Array = NDArray[np.float64]

_HALF_TURN_DEG = 180.0  # shown of a joint that turns without end
_SLIDERS_DEG = [
    np.clip(np.degrees(ends), -_HALF_TURN_DEG, _HALF_TURN_DEG).round(2).tolist() for ends in travel()
]


@dataclass(frozen=True)
class MachineState:
    """What the console shows.

    Attributes:
        mode: Of the sequencer.
        step: Name of the current step, empty where there is none.
        step_number: Its place, from 0.
        time_in_step: In s.
        planned: Planned time of the step in s.
        position: Measured joints in rad, shape (14,).
        desired: Set points in rad, shape (14,).
        valves_open: Whether the arms may move.
        reason: Why the link is lost, or empty.
        manual: `joystick` or `sliders` while the operator moves joints by hand, else empty.
        signals: Voltages and pressures, of a machine that has them.
        pipe: Where a loose simulated pipe is, world frame; None without one.
    """

    mode: Mode
    step: str
    step_number: int
    time_in_step: float
    planned: float
    position: Array
    desired: Array
    valves_open: bool
    reason: str
    manual: str = ""
    signals: Signals | None = None
    pipe: Pipe | None = None

    def shown(self) -> dict[str, Any]:
        """As plain values, angles in degrees, with how far the joints may go."""
        return {
            "mode": self.mode.name.lower(),
            "step": self.step,
            "step_number": self.step_number,
            "share": min(1.0, self.time_in_step / self.planned) if self.planned > 0 else 0.0,
            "valves_open": self.valves_open,
            "angles_deg": np.degrees(self.position).round(2).tolist(),
            "desired_deg": np.degrees(self.desired).round(2).tolist(),
            "manual": self.manual,
            "limits_deg": _SLIDERS_DEG,
            "signals": None if self.signals is None else shown(self.signals),
        }
