"""Proportional amplifiers A and B: voltage to coil current, equation (4.4)."""

import math
from typing import Any, NamedTuple

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.smooth import exponential
from hydrolek_drake.physics.usual import rare

STAGE = Stage(
    "amplifier",
    "voltage to coil current",
    (),
    {
        "proportional": (
            Parameter("min_current", "A", "coil current at 0 V, I_min in (4.4)", lowest=0.0),
            Parameter("max_current_a", "A", "current of coil A at full voltage, I_maxA in (4.4)", lowest=0.0),
            Parameter("max_current_b", "A", "current of coil B at full voltage, I_maxB in (4.4)", lowest=0.0),
            Parameter(
                "full_voltage", "V", "voltage of full current, 10 V in (4.4)", lowest=0.0, positive=True
            ),
            Parameter(
                "coil_time",
                "s",
                "time constant of a coil's current, inductance over resistance; 0 for none",
                neutral=0.0,
                lowest=0.0,
            ),
        ),
        "none": (),
        "pwm": (
            Parameter("supply_voltage", "V", "that the transistor switches on to the coil", lowest=0.0),
            Parameter("resistance", "ohm", "of a coil", lowest=0.0, positive=True),
            Parameter("coil_time", "s", "inductance over resistance of a coil", lowest=0.0, positive=True),
            Parameter("frequency", "Hz", "of the pulses", lowest=0.0, positive=True),
            Parameter("least_duty", "1", "share of a pulse at 0 V of command", lowest=0.0, highest=1.0),
            Parameter("most_duty", "1", "share of a pulse at full command", lowest=0.0, highest=1.0),
            Parameter("full_voltage", "V", "command of the largest share", lowest=0.0, positive=True),
        ),
    },
)
PROPORTIONAL = float(STAGE.code("proportional"))
PWM = float(STAGE.code("pwm"))


@njit
def pulsed_current(duty: float, joint: Any) -> float:
    """Root mean square of the current of a coil that pulses drive [A], which says its force.

    The mean is d U/R; around it the current goes up and down in straight lines by U d (1 - d)/(L f), a twelfth of
    whose square is added to that of the mean (Mohan, Undeland, Robbins, Power Electronics, section 7.3). For pulses
    that are short beside the coil's time constant; a diode carries the current between them.

    Args:
        duty: share of a pulse's time that is on, d.
        joint: parameter record.
    """
    p = joint.amplifier
    mean = duty * p.supply_voltage / p.resistance
    ripple = p.supply_voltage * duty * (1.0 - duty) / (p.resistance * p.coil_time * p.frequency)
    return math.sqrt(mean * mean + ripple * ripple / 12.0)


@njit
def coil_currents(voltage: float, time: float, joint: Any) -> tuple[float, float]:
    """Currents of coils A and B [A], equation (4.4); a positive voltage drives A, a negative one B.

    Without an amplifier (a servo valve has its own) the voltage itself goes on, split by its sign.

    Args:
        voltage: at the amplifier, positive towards chamber A [V].
        time: since the machine was switched on [s], for coils that warm up.
        joint: parameter record.
    """
    p = joint.amplifier
    if rare(joint) and p.variant == PWM:
        share = min(abs(voltage) / p.full_voltage, 1.0)
        driven = pulsed_current(p.least_duty + share * (p.most_duty - p.least_duty), joint)
        other = pulsed_current(p.least_duty, joint)
        return (driven, other) if voltage >= 0.0 else (other, driven)
    if p.variant != PROPORTIONAL:
        return max(voltage, 0.0), max(-voltage, 0.0)
    gain = hooks.coil_gain(time, joint)
    share = min(abs(voltage) / p.full_voltage, 1.0)
    if voltage >= 0.0:
        driven = p.min_current + share * (p.max_current_a - p.min_current)
        return gain * driven, gain * p.min_current
    driven = p.min_current + share * (p.max_current_b - p.min_current)
    return gain * p.min_current, gain * driven


class Currents(NamedTuple):
    """Of the coils [A]; where there is no amplifier the voltage itself [V]."""

    a: float
    b: float


@njit
def following(
    before: Currents, voltage: float, time: float, h: float, more: float, joint: Any
) -> tuple[Currents, Currents]:
    """Currents after `h` seconds of a held voltage, and their means over them.

    A coil's current follows what drives it, (4.4), as a resistance and an inductance let it: di/dt = (i_driven - i)/T.

    Args:
        before: currents so far.
        voltage: at the amplifier [V].
        time: since the machine was switched on [s].
        h: [s], more than none.
        more: added to the rig's time constant [s].
        joint: parameter record.
    """
    a, b = coil_currents(voltage, time, joint)
    p = joint.amplifier
    slowed = p.variant == PROPORTIONAL or (rare(joint) and p.variant == PWM)
    if not slowed or p.coil_time + more <= 0.0:
        return Currents(a, b), Currents(a, b)
    constant = p.coil_time + more
    left = exponential(-h / constant)
    mean = constant / h * (1.0 - left)
    off_a, off_b = before.a - a, before.b - b
    return Currents(a + off_a * left, b + off_b * left), Currents(a + off_a * mean, b + off_b * mean)
