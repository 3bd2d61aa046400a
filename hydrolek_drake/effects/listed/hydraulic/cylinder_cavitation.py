"""A chamber that takes more oil than flows in has a cavity, which oil must fill again."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.effect import Effect, Formula, Search
from hydrolek_drake.physics.parameters import Parameter

EFFECT = Effect(
    id="cylinder.cavitation",
    title="cavities in the chambers",
    equation="a chamber without pressure that still takes oil has a cavity; share refilled of it must be filled by oil "
    "before the pressure rises again",
    parameters=(
        Parameter(
            "refilled",
            "1",
            "share of a cavity that oil has to fill again",
            neutral=0.0,
            lowest=0.0,
            highest=1.0,
        ),
    ),
    formula=Formula(
        r"\dot{V}_c = \sigma \left( A v - Q \right) \; \left( Q < A v \right), \quad \dot{V}_c = A v - Q \; "
        r"\left( Q > A v \right), \quad p V_c = 0",
        {"refilled": r"\sigma"},
        {
            "V_c": "volume of a chamber's cavity",
            "A v": "volume that the piston frees a second",
            "Q": "oil flow into the chamber",
            "p": "its pressure",
        },
    ),
    inspect=(
        "Where a load pulls the piston or a valve closes quickly, watch whether the pressure of the chamber that grows "
        "stays at zero for a while and is late to rise."
    ),
    size="refilled",
    search={
        "refilled": Search("unity", 1, (1.0, 0.3)),
    },
    source="continuity of a chamber at zero pressure, Merritt, Hydraulic Control Systems (1967), section 3.4; Wylie "
    "and Streeter, Fluid Transients in Systems (1993), chapter 8",
    confused_with={
        "fluid.entrained_air": "air softens the oil at every low pressure, a cavity only after the pressure was zero",
        "linkage.backlash": "a play delays the link where the load changes sides, a cavity where a chamber was empty",
    },
    needs={"cylinder": ("cylinder", "vane", "hydraulic_motor")},
)


@EFFECT.hook("cavity_refilled")
@njit
def cavity_refilled(joint: Any) -> float:
    """Share of a cavity that oil has to fill again."""
    return joint.effects.cylinder_cavitation.refilled
