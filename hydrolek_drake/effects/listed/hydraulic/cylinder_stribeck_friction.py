"""Seal friction that falls as the rod starts to move."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import STICKS_AND_SLIPS, Effect, Formula, Search
from hydrolek_drake.physics.friction import Sliding, stribeck
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.stribeck_friction",
    title="Coulomb and Stribeck friction of the seals",
    equation="(coulomb + stribeck e^(-|v/v_s|^n)) tanh(v / friction_velocity) against the rod, or as bristles hold it",
    parameters=(
        Parameter("coulomb_N", "N", "Coulomb friction of the seals", neutral=0.0, lowest=0.0),
        Parameter("stribeck_N", "N", "further friction near zero speed", neutral=0.0, lowest=0.0),
        Parameter(
            "stribeck_velocity_m_per_s",
            "m/s",
            "speed over which it fades",
            neutral=1.0,
            lowest=0.0,
            positive=True,
        ),
        Parameter("fading_exponent", "1", "exponent of its fading", neutral=2.0, lowest=0.5),
    ),
    formula=Formula(
        r"F = \left( F_C + F_S e^{-|v/v_S|^n} \right) \tanh \left( \frac{v}{v_0} \right)",
        {
            "coulomb_N": "F_C",
            "stribeck_N": "F_S",
            "stribeck_velocity_m_per_s": "v_S",
            "fading_exponent": "n",
        },
        {"F": "force against the rod", "v": "speed of the rod", "v_0": "friction velocity of the rig"},
    ),
    inspect=(
        "Move the joint slowly and see whether it sticks and slips; look at seals and guide bands, a dry "
        "or scored rod, and the oil's lubricity."
    ),
    step_share=STICKS_AND_SLIPS,
    size="stribeck_N",
    reads=(
        "cylinder.friction_velocity",
        "cylinder.bristle_deflection",
        "cylinder.bristle_time",
        "effects.cylinder.stribeck_friction.fading_exponent",
    ),
    beneath="rubbing",
    contains=("cylinder.coulomb_friction",),
    search={
        "coulomb_N": Search("force", 0.4, (0.01, 0.05)),
        "stribeck_N": Search("force", 0.4, (0.01, 0.05)),
        "stribeck_velocity_m_per_s": Search("rod_speed", 2.0, (0.03, 0.15), lowest=0.005, log=True),
    },
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, Stribeck curve",
    confused_with={
        "cylinder.coulomb_friction": "Coulomb friction does not fall with speed; creeping speed decides",
        "valve.spool_stiction": "a sticking spool shows in the pressures only after the command reverses",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("rod_friction")
@njit
def rod_friction(at: Sliding, joint: Any) -> tuple[float, float]:
    """Friction [N] and its secant slope [N s/m] as the seals rub."""
    p = joint.effects.cylinder_stribeck_friction
    return stribeck(
        at,
        p.coulomb_N,
        p.stribeck_N,
        p.stribeck_velocity_m_per_s,
        p.fading_exponent,
    )
