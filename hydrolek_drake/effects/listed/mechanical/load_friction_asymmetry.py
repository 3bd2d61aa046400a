"""Friction that differs between the two directions."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter
from hydrolek_drake.physics.smooth import hyperbolic_tangent

EFFECT = Effect(
    id="load.friction_asymmetry",
    title="friction depends on direction",
    equation="(coulomb + damping |v|) tanh(v / friction_velocity)^2 against the positive direction",
    parameters=(
        Parameter(
            "coulomb_N", "N", "half the difference of Coulomb friction, forward less backward", neutral=0.0
        ),
        Parameter(
            "damping_N_s_per_m",
            "N s/m",
            "half the difference of viscous friction, forward less backward",
            neutral=0.0,
        ),
    ),
    formula=Formula(
        r"F = \left( F_C + d \left| v \right| \right) \tanh^2 \left( \frac{v}{v_0} \right)",
        {"coulomb_N": "F_C", "damping_N_s_per_m": "d"},
        {
            "F": "force against the positive direction",
            "v": "speed of the load",
            "v_0": "friction velocity of the rig",
        },
    ),
    inspect=(
        "Measure the force at the same slow speed both ways: wipers, preload of bearings, a gear that is "
        "loaded on one flank."
    ),
    size="damping_N_s_per_m",
    reads=("load.friction_velocity",),
    search={
        "coulomb_N": Search("load_force", 0.2, (0.005, -0.005), lowest=-0.2),
        "damping_N_s_per_m": Search("load_damping", 0.5, (0.01, -0.01), lowest=-0.5),
    },
    searched_on={"cylinder": ("electric_motor", "ball_screw", "servo_screw")},
    source="Janot, Young, Gautier, Int. J. Control 90 (2017) 643: fatigue of the screw",
    confused_with={
        "load.offset_force": "an offset acts at rest too",
    },
)


@EFFECT.hook("load_friction")
@njit
def load_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Force [N] and its slope [N s/m]."""
    p = joint.effects.load_friction_asymmetry
    if p.coulomb_N == 0.0 and p.damping_N_s_per_m == 0.0:
        return 0.0, 0.0
    share = hyperbolic_tangent(velocity / joint.load.friction_velocity)
    return (p.coulomb_N + p.damping_N_s_per_m * abs(velocity)) * share * share, 0.0
