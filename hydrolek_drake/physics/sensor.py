"""The potentiometer, equations (3.1) to (3.3), and what can be wrong with a reading."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

_TRAVEL = (
    Parameter("travel_lower", "rad|m", "lower end of the sensor's travel"),
    Parameter("travel_upper", "rad|m", "upper end of the sensor's travel"),
    Parameter("noise", "rad|m", "standard deviation of the reading's noise", neutral=0.0, lowest=0.0),
    Parameter("resolution", "rad|m", "smallest step of the reading", neutral=0.0, lowest=0.0),
)
STAGE = Stage(
    "sensor",
    "joint position to reading",
    (
        *_TRAVEL,
        Parameter(
            "pressure_noise",
            "Pa",
            "standard deviation of the pressure readings' noise",
            neutral=0.0,
            lowest=0.0,
        ),
        Parameter(
            "current_noise",
            "A",
            "standard deviation of the noise of a motor's current reading",
            neutral=0.0,
            lowest=0.0,
        ),
        Parameter(
            "current_offset",
            "A",
            "reading of a motor's current where it draws none for its force",
            neutral=0.0,
        ),
        Parameter(
            "current_size",
            "1",
            "1 where the size of a motor's current is read alone, 0 with its sign",
            neutral=0.0,
            lowest=0.0,
            highest=1.0,
        ),
    ),
    {
        "position": (),
        "potentiometer": (
            Parameter(
                "volts_per_degree",
                "V/deg",
                "alpha in (3.1), volts per degree (see docs/reference/thesis_errata.md)",
            ),
            Parameter("zero_voltage", "V", "reading at zero degrees, V_0 in (3.2)"),
        ),
    },
)
POTENTIOMETER = float(STAGE.code("potentiometer"))


@njit
def played(reading: float, position: float, joint: Any) -> float:
    """Play operator: the reading follows the position only at the edges of its play [rad or m]."""
    half = hooks.reading_play(joint)
    return min(max(reading, position - half), position + half)


@njit
def reading(held: float, time: float, joint: Any) -> float:
    """What the sensor says [rad or m] when its shaft stands at `held`, without noise."""
    return held + hooks.reading_error(held, time, joint)


@njit
def current_reading(current: float, joint: Any) -> float:
    """What a sensor says of a motor's current [A]: i_0 + i, or i_0 + |i| of one that has no sign, without noise."""
    p = joint.sensor
    return p.current_offset + (abs(current) if p.current_size > 0.0 else current)


@njit
def volts_per_degree(v_min: float, v_max: float, d_min_deg: float, d_max_deg: float) -> float:
    """Potentiometer scaling alpha [V/deg], equation (3.1) in the sense that Table 3.2 uses."""
    return (v_max - v_min) / (d_max_deg - d_min_deg)


@njit
def zero_voltage(v_min: float, d_min_deg: float, alpha: float) -> float:
    """Reading at zero degrees V_0 [V], equation (3.2) with its sign: V_min - D_min alpha."""
    return v_min - d_min_deg * alpha


@njit
def potentiometer_voltage(angle_deg: float, joint: Any) -> float:
    """Voltage of the potentiometer [V] at an angle in degrees, (3.3) turned round."""
    return joint.sensor.zero_voltage + joint.sensor.volts_per_degree * angle_deg


@njit
def angle_from_voltage(voltage: float, joint: Any) -> float:
    """Angle in degrees from the potentiometer's voltage, equation (3.3)."""
    return (voltage - joint.sensor.zero_voltage) / joint.sensor.volts_per_degree
