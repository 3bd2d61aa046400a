"""Dry friction of the seals."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.friction import Sliding, coulomb_friction
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.coulomb_friction",
    title="seal friction",
    equation="coulomb tanh(v / friction_velocity) against the rod, or as the rig's bristles hold it",
    parameters=(Parameter("coulomb_N", "N", "Coulomb friction of the seals", neutral=0.0, lowest=0.0),),
    formula=Formula(
        r"F = F_C \tanh \left( \frac{v}{v_0} \right)",
        {"coulomb_N": "F_C"},
        {"F": "force against the rod", "v": "speed of the rod", "v_0": "friction velocity of the rig"},
    ),
    inspect=(
        "Look at the seals of rod and piston: pressure at which the unloaded joint breaks away, scored "
        "rod, seals too tight, side load of mounts out of line."
    ),
    size="coulomb_N",
    reads=("cylinder.friction_velocity", "cylinder.bristle_deflection", "cylinder.bristle_time"),
    beneath="rubbing",
    search={
        "coulomb_N": Search("force", 0.4, (0.01, 0.06)),
    },
    source="thesis (4.1), F_c; Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083",
    confused_with={
        "cylinder.stribeck_friction": "with Stribeck the friction falls as the rod starts to move",
        "valve.asymmetric_overlap": "overlap leaves the pressures' step at reversals alone",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("rod_friction")
@njit
def rod_friction(at: Sliding, joint: Any) -> tuple[float, float]:
    """Friction [N] and its secant slope [N s/m] as the seals rub."""
    return coulomb_friction(at, joint.effects.cylinder_coulomb_friction.coulomb_N)
