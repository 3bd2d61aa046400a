"""Dry friction of the joint's own bearing that falls as the load starts to move."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import STICKS_AND_SLIPS, Effect, Formula, Search
from hydrolek_drake.physics.friction import Sliding, stribeck
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="load.stribeck_friction",
    title="Coulomb and Stribeck friction of the joint's bearing",
    equation="(force + stribeck e^(-|w/w_s|^n)) tanh(w / friction_velocity) against the load",
    parameters=(
        Parameter("force_N", "N", "Coulomb friction", neutral=0.0, lowest=0.0),
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
            "force_N": "F_C",
            "stribeck_N": "F_S",
            "stribeck_velocity_m_per_s": "v_S",
            "fading_exponent": "n",
        },
        {"F": "force or moment against the load", "v": "its speed", "v_0": "friction velocity of the rig"},
    ),
    inspect=(
        "Move the load slowly with the drive uncoupled and see whether it sticks and slips: grease, "
        "preload and seals of the bearing."
    ),
    step_share=STICKS_AND_SLIPS,
    size="stribeck_N",
    reads=("load.friction_velocity", "effects.load.stribeck_friction.fading_exponent"),
    beneath="load_rubbing",
    contains=("load.coulomb_friction",),
    search={
        "force_N": Search("load_force", 0.4, (0.01, 0.05)),
        "stribeck_N": Search("load_force", 0.4, (0.01, 0.05)),
        "stribeck_velocity_m_per_s": Search("load_speed", 2.0, (0.03, 0.15), lowest=0.005, log=True),
    },
    searched_on={"load": ("link",)},
    source="Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30 (1994) 1083, Stribeck curve",
    confused_with={
        "load.coulomb_friction": "Coulomb friction does not fall with speed; creeping speed decides",
        "cylinder.stribeck_friction": "seals rub at the rod, so that their moment follows the lever",
    },
)


@EFFECT.hook("load_friction")
@njit
def load_friction(velocity: float, joint: Any) -> tuple[float, float]:
    """Friction [N or N m] and its secant slope."""
    p = joint.effects.load_stribeck_friction
    at = Sliding(velocity, joint.load.friction_velocity, 0.0)
    return stribeck(
        at,
        p.force_N,
        p.stribeck_N,
        p.stribeck_velocity_m_per_s,
        p.fading_exponent,
    )
