"""Controllers that give volts, through the operator computer as on the machine (thesis 4.2, 6.2.3).

On the machine a controller's output is the signal S_in of (4.2) and (4.3), whose calibration makes a voltage of it, and
that goes to the joint's channel of the field point (Table 3.1). The laws of this package give the voltage itself: a
scaled input has done (6.7) and (6.8), which are (4.2) and (4.3) with Table 6.3 for A to D, and an inverse dead-zone
needs voltages within the dead-zone too. Their calibration is therefore A = C = 0, B = D = the largest voltage: S_in is
the voltage in percent of that, and what arrives at the amplifiers is the voltage that the law gave, limited.
"""

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.thesis_gains import signal_limit
from hydrolek_drake.physics.command import CALIBRATED
from hydrolek_drake.rigs import Rig


def through_operator_computer(rig: Rig) -> tuple[Rig, NDArray[np.float64] | None]:
    """A rig whose operator computer passes voltages, and the signal that stands for a volt.

    Args:
        rig: the machine.

    Returns:
        The rig with A = C = 0 and B = D = `command.limit` on every joint, and signal per volt [percent/V], shape (n,).
        A rig without channels, such as a bench, has no operator computer: it comes back as it is, with None.
    """
    command = rig.records()["command"]
    if not np.all(command["variant"] == CALIBRATED):
        return rig, None
    values: dict[str, float] = {}
    for joint, limit in zip(rig.joints, command["limit"], strict=True):
        for key in "abcd":
            values[f"joints.{joint}.command.calibration_{key}"] = float(limit) if key in "bd" else 0.0
    return rig.with_values(values), signal_limit() / command["limit"]
