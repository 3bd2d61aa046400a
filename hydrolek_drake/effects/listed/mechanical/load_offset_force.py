"""A constant force at the load."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.offset_force",
    title="constant force",
    equation="force against the positive direction",
    parameters=(Parameter("force_N", "N", "constant force against the positive direction", neutral=0.0),),
    formula=Formula("F = F_0", {"force_N": "F_0"}, {"F": "force against the positive direction"}),
    inspect=(
        "Look for what pulls one way: tilt of the axis, a spring, cable or hose; then the zero of the "
        "amplifier or of the force's sensor."
    ),
    size="force_N",
    search={
        "force_N": Search("load_force", 0.5, (0.01, -0.01), lowest=-0.5),
    },
    searched_on={"cylinder": ("electric_motor", "ball_screw", "servo_screw")},
    source="Janot, Gautier, Brunot, EMPS benchmark (2019): offset of the drive",
    confused_with={
        "load.friction_asymmetry": "an offset acts at rest too",
    },
)


@EFFECT.hook("load_friction")
@njit
def load_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Force [N] and its slope, which is zero."""
    return joint.effects.load_offset_force.force_N, 0.0
