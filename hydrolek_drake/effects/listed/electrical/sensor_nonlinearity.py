"""The potentiometer's track is bowed."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="sensor.nonlinearity",
    title="bowed sensor",
    equation="reading + amplitude (1 - z^2), z from -1 to 1 over the travel",
    parameters=(Parameter("amplitude_rad", "rad", "bow in the middle of the travel", neutral=0.0),),
    formula=Formula(
        r"y = \theta + a \left( 1 - z^2 \right)",
        {"amplitude_rad": "a"},
        {
            "y": "reading",
            r"\theta": "true position",
            "z": "place in the travel, -1 at one end and 1 at the other",
        },
    ),
    inspect=(
        "Calibrate the sensor against an angle gauge at five places of the travel; a bow comes from a "
        "worn track, an eccentric mount or a load on the wiper."
    ),
    size="amplitude_rad",
    beneath="bit",
    search={
        "amplitude_rad": Search("travel", 0.1, (0.01, -0.01), lowest=-0.1),
    },
    source="conformity error of potentiometers; lowest even term that vanishes at the calibrated ends",
    confused_with={
        "cylinder.end_cushion": "a cushion acts only while moving inwards",
    },
)


@EFFECT.hook("reading_error")
@njit
def reading_error(position: float, time: float, joint: Any) -> float:
    """Error of the reading [rad]."""
    amplitude = joint.effects.sensor_nonlinearity.amplitude_rad
    if amplitude == 0.0:
        return 0.0
    p = joint.sensor
    z = 2.0 * (position - p.travel_lower) / (p.travel_upper - p.travel_lower) - 1.0
    return amplitude * (1.0 - z * z)
