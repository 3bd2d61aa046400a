"""What the console shows of the machine."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.teleop.link.signals import Signals
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.workcell.pipe import Pipe

Array = NDArray[np.float64]


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
