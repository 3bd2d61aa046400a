"""The oil thins as it warms."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import exponential

EFFECT = Effect(
    id="fluid.warm_up",
    title="oil warms up",
    equation="with s = fraction (1 - e^(-t/time_constant)): viscous friction times 1 - s, flow coefficient times 1 + s",
    parameters=(
        Parameter("fraction", "1", "change when warm", neutral=0.0, highest=1.0),
        Parameter(
            "time_constant_s", "s", "time constant of the warming", neutral=1.0, lowest=0.0, positive=True
        ),
    ),
    formula=Formula(
        r"s = f \left( 1 - e^{-t/\tau} \right), \quad d = d_0 (1 - s), \quad C = C_0 (1 + s)",
        {"fraction": "f", "time_constant_s": r"\tau"},
        {
            "s": "change by then",
            "d": "viscous friction of the cylinder",
            "C": "flow coefficient of the valve",
            "d_0, C_0": "both when cold",
            "t": "time",
        },
    ),
    inspect=(
        "Record the oil's temperature and check its viscosity grade; warm the machine up before measuring."
    ),
    size="fraction",
    search={
        "fraction": Search("unity", 0.7, (0.05, 0.25)),
        "time_constant_s": Search("duration", 3, (0.1, 0.4), lowest=0.02, log=True),
    },
    source="mineral oil loses about half of its viscosity per 15 K",
    confused_with={
        "amplifier.gain_fade": "a fading gain slows the joint down and widens the dead-zone",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@njit
def _share(time: float, joint: Any) -> float:
    p = joint.effects.fluid_warm_up
    if p.fraction == 0.0:
        return 0.0
    return p.fraction * (1.0 - exponential(-time / p.time_constant_s))


@EFFECT.hook("viscous_gain")
@njit
def viscous_gain(time: float, joint: Any) -> float:
    """Factor on the cylinder's viscous friction."""
    return 1.0 - _share(time, joint)


@EFFECT.hook("flow_gain")
@njit
def flow_gain(time: float, joint: Any) -> float:
    """Factor on the flow coefficient."""
    return 1.0 + _share(time, joint)
