"""Seal friction that differs between the two directions."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.friction import Sliding, sign_of
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.friction_asymmetry",
    title="seal friction depends on direction",
    equation="coulomb tanh(v / friction_velocity)^2 against extension",
    parameters=(
        Parameter(
            "coulomb_N", "N", "half the difference of Coulomb friction, rod out less rod in", neutral=0.0
        ),
    ),
    formula=Formula(
        r"F = F_C \tanh^2 \left( \frac{v}{v_0} \right)",
        {"coulomb_N": "F_C"},
        {"F": "force against extension", "v": "speed of the rod", "v_0": "friction velocity of the rig"},
    ),
    inspect=(
        "Compare the pressure difference at the same slow speed out and in; then look at wiper, rod seal "
        "and side load."
    ),
    size="coulomb_N",
    reads=("cylinder.friction_velocity", "cylinder.bristle_deflection", "cylinder.bristle_time"),
    search={
        "coulomb_N": Search("force", 0.2, (0.01, -0.01), lowest=-0.2),
    },
    # where gravity loads the joint, it and the lever pass for a difference between the directions
    searched_on={"load": ("sliding",)},
    source="ingxfm, Festo TP511 recordings (2020): 65 N out, 75 N in; as load.friction_asymmetry without speed",
    confused_with={
        "cylinder.coulomb_friction": "Coulomb friction is the part that both directions share",
        "load.offset_force": "an offset acts at rest too",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("rod_friction")
@njit
def rod_friction(at: Sliding, joint: Any) -> tuple[float, float]:
    """Force [N] and its secant slope [N s/m], zero since it pushes rather than brakes in one direction."""
    coulomb = joint.effects.cylinder_friction_asymmetry.coulomb_N
    if coulomb == 0.0:
        return 0.0, 0.0
    share = sign_of(at)
    return coulomb * share * share, 0.0
