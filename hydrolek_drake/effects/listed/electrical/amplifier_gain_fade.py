"""The coils warm up and draw less current."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import exponential

EFFECT = Effect(
    id="amplifier.gain_fade",
    title="gain falls as the coil warms",
    equation="currents times 1 - fraction (1 - e^(-t/time_constant))",
    parameters=(
        Parameter("fraction", "1", "share of the current that is lost when warm", neutral=0.0, highest=1.0),
        Parameter(
            "time_constant_s", "s", "time constant of the warming", neutral=1.0, lowest=0.0, positive=True
        ),
    ),
    formula=Formula(
        r"i = i_0 \left( 1 - s \left( 1 - e^{-t/\tau} \right) \right)",
        {"fraction": "s", "time_constant_s": r"\tau"},
        {"i": "current of a coil", "i_0": "current when cold", "t": "time"},
    ),
    inspect=(
        "Measure the coils' resistance cold and warm and the amplifier's supply voltage under load; an "
        "amplifier that controls the current keeps it whatever the temperature."
    ),
    size="fraction",
    search={
        "fraction": Search("unity", 0.5, (0.03, 0.15)),
        "time_constant_s": Search("duration", 3, (0.1, 0.4), lowest=0.02, log=True),
    },
    source="copper's resistance rises 0.39 % per kelvin while the amplifier holds its voltage",
    confused_with={
        "fluid.warm_up": "warming oil speeds the joint up and leaves the dead-zone alone",
        "sensor.drift": "a drifting sensor also drifts at rest",
    },
    needs={"amplifier": ("proportional",)},
)


@EFFECT.hook("coil_gain")
@njit
def coil_gain(time: float, joint: Any) -> float:
    """Factor on both coil currents after `time` seconds."""
    p = joint.effects.amplifier_gain_fade
    if p.fraction == 0.0:
        return 1.0
    return 1.0 - p.fraction * (1.0 - exponential(-time / p.time_constant_s))
