"""From the recorded or commanded voltage to the amplifier's input; the operator computer's calibration."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

STAGE = Stage(
    "command",
    "transport of the command from the computer to the amplifier",
    (
        Parameter("delay", "s", "transport delay of the command", lowest=0.0, arrival=True),
        Parameter("neutral", "V", "command at which nothing is driven", neutral=0.0),
        Parameter("limit", "V", "largest command away from neutral", lowest=0.0),
        Parameter(
            "polarity", "1", "1, or -1 if a higher voltage retracts", neutral=1.0, lowest=-1.0, highest=1.0
        ),
        Parameter(
            "ramp", "s/V", "time that a card's ramp takes for each volt, 0 for none", neutral=0.0, lowest=0.0
        ),
    ),
    {
        "voltage": (),
        "calibrated": (
            Parameter(
                "calibration_a", "V", "voltage A at the smallest positive signal, A_i in (4.2)", lowest=0.0
            ),
            Parameter("calibration_b", "V", "voltage A at signal 100, B_i in (4.2)", lowest=0.0),
            Parameter(
                "calibration_c", "V", "voltage B at the smallest negative signal, C_i in (4.3)", lowest=0.0
            ),
            Parameter("calibration_d", "V", "voltage B at signal -100, D_i in (4.3)", lowest=0.0),
            Parameter("module", "1", "Compact Field Point module of Table 3.1", lowest=0.0),
            Parameter(
                "channel_a",
                "1",
                "channel that moves the joint in positive direction, Table 3.1",
                lowest=0.0,
                highest=7.0,
            ),
            Parameter(
                "channel_b",
                "1",
                "channel that moves the joint in negative direction, Table 3.1",
                lowest=0.0,
                highest=7.0,
            ),
        ),
    },
)
CALIBRATED = float(STAGE.code("calibrated"))


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
def ramped(begin: float, voltage: float, h: float, more: float, joint: Any) -> tuple[float, float]:
    """Voltage behind a card's ramp [V] after `h` seconds of a held one, and its mean over them.

    du/dt = +-1/r until the voltage is reached: the ramp of a proportional amplifier's card, which spares a machine the
    jump.

    Args:
        begin: voltage behind the ramp so far [V].
        voltage: before it [V].
        h: [s], more than none.
        more: added to the rig's ramp [s/V].
        joint: parameter record.
    """
    way = voltage - begin
    needed = max(joint.command.ramp + more, 0.0) * abs(way)
    if needed <= h:
        return voltage, voltage - 0.5 * way * needed / h
    gone = way * h / needed
    return begin + gone, begin + 0.5 * gone


@njit
def calibrated_voltages(signal: float, joint: Any) -> tuple[float, float]:
    """Voltages for amplifiers A and B [V] from the operator's signal S_in, -100 to 100 %; (4.2), (4.3)."""
    p = joint.command
    share = min(abs(signal) / 100.0, 1.0)
    if signal > 0.0:
        return p.calibration_a + share * (p.calibration_b - p.calibration_a), 0.0
    if signal < 0.0:
        return 0.0, p.calibration_c + share * (p.calibration_d - p.calibration_c)
    return 0.0, 0.0
