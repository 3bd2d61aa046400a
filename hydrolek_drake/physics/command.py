"""From the recorded or commanded voltage to the amplifier's input; the operator computer's calibration."""

from typing import Any

from numba import njit

from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

STAGE = Stage(
    "command",
    "transport of the command from the computer to the amplifier",
    (
        Parameter("delay", "s", "transport delay of the command", lowest=0.0),
        Parameter("neutral", "V", "command at which nothing is driven", neutral=0.0),
        Parameter("limit", "V", "largest command away from neutral", lowest=0.0),
        Parameter("polarity", "1", "1, or -1 if a higher voltage retracts", neutral=1.0, lowest=-1.0, highest=1.0),
    ),
    {"voltage": ()},
)


@njit
def transport_delay(joint: Any) -> float:
    """Seconds between a command and its arrival at the amplifier (thesis 6.1.3: the time delay tau)."""
    return joint.command.delay + hooks.command_delay(joint)


@njit
def drive_voltage(command: float, joint: Any) -> float:
    """Voltage at the amplifier [V]: distance from neutral, positive towards chamber A, limited."""
    p = joint.command
    voltage = p.polarity * (command - p.neutral)
    return min(max(voltage, -p.limit), p.limit)


@njit
def calibrated_voltages(signal: float, a: float, b: float, c: float, d: float) -> tuple[float, float]:
    """Voltages for amplifiers A and B [V] from the operator's signal in percent, equations (4.2), (4.3).

    Args:
        signal: S_in, from -100 to 100.
        a: voltage A at the smallest positive signal [V].
        b: voltage A at signal 100 [V].
        c: voltage B at the smallest negative signal [V].
        d: voltage B at signal -100 [V].
    """
    if signal > 0.0:
        return a + signal * (b - a) / 100.0, 0.0
    if signal < 0.0:
        return 0.0, c - signal * (d - c) / 100.0
    return 0.0, 0.0
