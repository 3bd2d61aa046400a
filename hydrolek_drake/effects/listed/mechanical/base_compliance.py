"""The base rocks against a spring."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="base.compliance",
    title="rocking base",
    equation="J_b b'' = -(actuator moment) - k b - 2 zeta sqrt(k J_b) b'; cylinder and sensor see q - b",
    parameters=(
        Parameter(
            "stiffness_Nm_per_rad", "N m/rad", "spring of the base (0: rigid)", neutral=0.0, lowest=0.0
        ),
        Parameter("inertia_kg_m2", "kg m^2", "inertia of the base", neutral=1.0, lowest=0.0, positive=True),
    ),
    formula=Formula(
        r"J_b \ddot b = -M - k b - 2 \zeta \sqrt{k J_b} \, \dot b",
        {"stiffness_Nm_per_rad": "k", "inertia_kg_m2": "J_b"},
        {"b": "angle of the base", "M": "moment of the actuator", r"\zeta": "damping ratio"},
    ),
    inspect=(
        "Watch the base with a dial gauge or a camera while the joint starts and stops: mounting bolts, "
        "tracks, outriggers, soft ground."
    ),
    size="stiffness_Nm_per_rad",
    weakens=True,
    search={
        "stiffness_Nm_per_rad": Search("load_stiffness", 10000, (300.0, 30.0, 5.0, 1.5), lowest=1, log=True),
        "inertia_kg_m2": Search("inertia", 30, (1.0, 0.3), lowest=0.03, log=True),
    },
    source="thesis 6.1.5: moving faster 'could lead to some movement of the platform base'",
    confused_with={
        "fluid.entrained_air": "air softens most where the pressure is low",
        "linkage.backlash": "a spring gives in proportion to the load, play does not",
    },
)


@EFFECT.hook("base_stiffness")
@njit
def base_stiffness(joint: Any) -> float:
    """Spring of the base [N m/rad], 0 where it is rigid."""
    return joint.effects.base_compliance.stiffness_Nm_per_rad


@EFFECT.hook("base_inertia")
@njit
def base_inertia(joint: Any) -> float:
    """Inertia of the base [kg m^2]."""
    return joint.effects.base_compliance.inertia_kg_m2
