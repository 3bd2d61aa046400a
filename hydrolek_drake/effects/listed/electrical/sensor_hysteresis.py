"""The sensor's shaft slips: play in the reading."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="sensor.hysteresis",
    title="play in the sensor",
    equation="play operator of half_width on the reading",
    parameters=(Parameter("half_width_rad", "rad", "half of the play", neutral=0.0, lowest=0.0),),
    formula=Formula(
        r"\left| y - \theta \right| \le b",
        {"half_width_rad": "b"},
        {"y": "reading, which stays until the play is taken up", r"\theta": "true position"},
    ),
    inspect=(
        "Look at the coupling between joint and sensor: set screw, belt, flexible coupling or pinion with "
        "play."
    ),
    size="half_width_rad",
    beneath="bit",
    search={
        "half_width_rad": Search("travel", 0.05, (0.002, 0.008)),
    },
    source="play operator, Krasnosel'skii and Pokrovskii, Systems with Hysteresis (1989)",
    confused_with={
        "linkage.backlash": "play in the linkage also shows in the pressures and as a free swing of the load",
    },
)


@EFFECT.hook("reading_play")
@njit
def reading_play(joint: Any) -> float:
    """Half width of the play [rad]."""
    return joint.effects.sensor_hysteresis.half_width_rad
