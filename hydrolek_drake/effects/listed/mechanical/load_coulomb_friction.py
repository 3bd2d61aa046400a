"""Dry friction at the load itself."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.friction import Sliding, coulomb_friction
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.coulomb_friction",
    title="dry friction of the guides or of the joint's bearing",
    equation="force tanh(v / friction_velocity) against the load",
    parameters=(Parameter("force_N", "N", "Coulomb friction", neutral=0.0, lowest=0.0),),
    formula=Formula(
        r"F = F_C \tanh \left( \frac{v}{v_0} \right)",
        {"force_N": "F_C"},
        {"F": "force or moment against the load", "v": "its speed", "v_0": "friction velocity of the rig"},
    ),
    inspect=(
        "Uncouple the drive and measure the force that moves the load slowly: dry or pinched guides, "
        "bearings, gear."
    ),
    size="force_N",
    reads=("load.friction_velocity",),
    beneath="load_rubbing",
    search={
        "force_N": Search("load_force", 0.5, (0.01, 0.06)),
    },
    searched_on={"cylinder": ("electric_motor", "ball_screw", "servo_screw"), "load": ("link",)},
    source="thesis (4.1), F_c; Janot, Gautier, Brunot, EMPS benchmark (2019)",
    confused_with={
        "cylinder.coulomb_friction": "seals rub at the rod, so that their moment follows the lever",
        "load.friction_asymmetry": "asymmetry is the part that differs between the directions",
    },
)


@EFFECT.hook("load_friction")
@njit
def load_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Friction [N] and its secant slope [N s/m]."""
    at = Sliding(velocity, joint.load.friction_velocity, 0.0)
    return coulomb_friction(at, joint.effects.load_coulomb_friction.force_N)
