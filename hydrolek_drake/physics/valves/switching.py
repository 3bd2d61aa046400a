"""Valves that a coil switches on and off: the spool stands in the middle or at an end, and takes its time between."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

PARAMETERS = (
    Parameter("threshold", "V", "voltage from which on a coil switches", lowest=0.0, positive=True),
    Parameter("full_stroke", "m", "spool stroke of a coil that is on", lowest=0.0, positive=True),
    Parameter(
        "opening_time", "s", "that the spool takes from the middle to its end", lowest=0.0, positive=True
    ),
    Parameter("closing_time", "s", "that it takes back", lowest=0.0, positive=True),
)


@njit
def switched(x: float, drive: float, h: float, joint: Any) -> tuple[float, float]:
    """Spool position [m] after `h` seconds of a held drive, and its mean velocity [m/s].

    The spool moves at one speed from the middle outwards and at another back, as data sheets give switching times
    (Linjama, Digital Fluid Power, 12th Scandinavian International Conference on Fluid Power (2011); dead time before it
    moves counts to `command.delay`).

    Args:
        x: position now, positive opens P to A [m].
        drive: voltage, positive towards A [V].
        h: [s].
        joint: parameter record.
    """
    p = joint.solenoid
    target = 0.0
    if drive >= p.threshold:
        target = p.full_stroke
    elif drive <= -p.threshold:
        target = -p.full_stroke
    inwards = p.full_stroke / p.closing_time
    outwards = p.full_stroke / p.opening_time
    # back as far as the middle, or to where it shall stand on this side
    stays = max(min(x, target), 0.0) if x >= 0.0 else min(max(x, target), 0.0)
    way = abs(x - stays)
    back = min(way, inwards * h)
    there = x - back if x >= stays else x + back
    left = h - back / inwards
    further = min(abs(target - there), outwards * left) if back >= way else 0.0
    reached = there + further if target >= there else there - further
    return reached, (reached - x) / h
