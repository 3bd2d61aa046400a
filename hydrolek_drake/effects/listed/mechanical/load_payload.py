"""A load at the tool that the model does not know."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.payload",
    title="unknown payload",
    equation="inertia + mass r^2 and gravity moment + mass g r from time_s on",
    parameters=(
        Parameter("mass_kg", "kg", "mass at the tool", neutral=0.0, lowest=0.0),
        Parameter("time_s", "s", "when it is picked up", neutral=0.0),
    ),
    formula=Formula(
        r"J = J_0 + m r^2, \quad M = M_0 + m g r, \quad t \ge t_0",
        {"mass_kg": "m", "time_s": "t_0"},
        {
            "J": "inertia",
            "M": "gravity moment",
            "r": "lever of the tool",
            "g": "gravity",
            "J_0, M_0": "both without payload",
            "t": "time",
        },
    ),
    inspect=(
        "Weigh what is at the tool, and ask what was picked up and when; tools or hoses added since the "
        "rig was written count too."
    ),
    size="mass_kg",
    reads=("load.payload_inertia",),
    search={
        "mass_kg": Search("payload", 0.5, (0.02, 0.1)),
        "time_s": Search("duration", 1, tuple(part / 16 for part in range(16)), moment=True),
    },
    source="rigid-body mechanics, thesis (4.1)",
    confused_with={
        "valve.asymmetric_overlap": "a shifted null leaves the pressures at rest alone",
    },
    needs={"load": ("rotating", "arm", "sliding", "link")},
    beneath="rod_payload",
)


@EFFECT.hook("payload")
@njit
def payload(time: float, joint: Any) -> float:
    """Mass carried at the tool [kg]."""
    p = joint.effects.load_payload
    if time >= p.time_s:
        return p.mass_kg
    return 0.0
