"""Viscous friction at the load itself."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.viscous_friction",
    title="viscous friction of the guides",
    equation="damping v against the load",
    parameters=(Parameter("damping_N_s_per_m", "N s/m", "added damping", neutral=0.0),),
    formula=Formula("F = d v", {"damping_N_s_per_m": "d"}, {"F": "force against the load", "v": "its speed"}),
    inspect=(
        "Check grease and temperature of guides and gear: thick or cold grease brakes in proportion to speed."
    ),
    size="damping_N_s_per_m",
    search={
        "damping_N_s_per_m": Search("load_damping", 1, (0.02, 0.1)),
    },
    searched_on={"cylinder": ("electric_motor", "ball_screw", "servo_screw")},
    source="thesis (4.1), F_v",
    confused_with={
        "load.coulomb_friction": "dry friction does not grow with speed",
    },
)


@EFFECT.hook("load_friction")
@njit
def load_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Friction [N] and its slope [N s/m]."""
    damping = joint.effects.load_viscous_friction.damping_N_s_per_m
    return damping * velocity, damping
