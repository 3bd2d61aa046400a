"""The reading drifts with time."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="sensor.drift",
    title="drifting sensor",
    equation="reading + rate t",
    parameters=(Parameter("rate_rad_per_min", "rad/min", "drift", neutral=0.0),),
    formula=Formula(
        r"y = \theta + r t",
        {"rate_rad_per_min": "r"},
        {"y": "reading", r"\theta": "true position", "t": "time"},
    ),
    inspect=(
        "Read the sensor at the same end stop before and after a run; then its reference voltage, its "
        "temperature and its clamp on the shaft."
    ),
    size="rate_rad_per_min",
    search={
        "rate_rad_per_min": Search("drift_per_min", 0.3, (0.01, -0.01), lowest=-0.3),
    },
    source="thesis 4.7: joint 5 'drifting that can be clearly seen'",
    confused_with={
        "cylinder.cross_port_leakage": "leakage moves the joint itself, and only under load",
    },
)

SECONDS_PER_MINUTE = 60.0


@EFFECT.hook("reading_error")
@njit
def reading_error(position: float, time: float, joint: Any) -> float:
    """Error of the reading [rad] after `time` seconds."""
    return joint.effects.sensor_drift.rate_rad_per_min * time / SECONDS_PER_MINUTE
