"""The oil: orifice flow and compressibility."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

STAGE = Stage(
    "fluid",
    "the oil",
    (
        Parameter("density", "kg/m^3", "rho in (4.7)", lowest=0.0, positive=True),
        Parameter("bulk_modulus", "Pa", "stiffness of oil with hoses", lowest=0.0, positive=True),
        Parameter(
            "laminar_transition",
            "Pa",
            "pressure drop below which orifice flow turns laminar",
            lowest=0.0,
            positive=True,
        ),
        Parameter(
            "atmospheric_pressure", "Pa", "pressure to which an air content refers", lowest=0.0, positive=True
        ),
        Parameter(
            "floor_time", "s", "time constant with which a pressure may fall to zero", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "cavity_refilled",
            "1",
            "share of a cavity in a chamber that oil has to fill again before its pressure rises",
            neutral=0.0,
            lowest=0.0,
            highest=1.0,
        ),
    ),
    {
        "oil": (),
        "polytropic_air": (
            Parameter(
                "air_exponent",
                "1",
                "polytropic exponent of air in the oil: 1 where it keeps its temperature, 1.4 where it has no time to",
                lowest=1.0,
            ),
        ),
    },
    default="oil",
)


@njit
def orifice_conductance(
    area: float, drop: float, coefficient: float, joint: Any, in_series: float = 1.0
) -> float:
    """Flow over pressure drop [m^3/(s Pa)] of an orifice, equation (4.7) made smooth through zero.

    Q = C_q A sqrt(2/rho) dp / (dp^2 + dp_t^2)^(1/4), which is (4.7) for |dp| well above the laminar
    transition dp_t and linear below it.

    Args:
        area: [m^2].
        drop: pressure drop dp [Pa].
        coefficient: contraction coefficient C_q.
        joint: parameter record.
        in_series: drop over all that the flow passes, over that of the orifice: 1 where it is alone.
    """
    fluid = joint.fluid
    smooth = math.sqrt(drop * drop + fluid.laminar_transition * fluid.laminar_transition)
    return coefficient * area * math.sqrt(2.0 / (fluid.density * smooth * in_series))


LEAST_CAPACITY = 0.1
"""A search may ask for less capacity than the oil has, down to this share: none at all has no solution."""


@njit
def softened(capacity: float, rate: float, stiffness: float) -> tuple[float, float]:
    """Rate [Pa/s] and stiffness [Pa/m^3] of a chamber where something besides the oil takes volume.

    With the chamber's stiffness B/V the oil takes V/B per pressure, and the rest `capacity`: both are 1 + capacity
    B/V times less.

    Args:
        capacity: volume that is taken per pressure besides the oil's [m^3/Pa].
        rate: of the pressure with the oil alone [Pa/s].
        stiffness: of the oil alone [Pa/m^3].
    """
    if capacity == 0.0:
        return rate, stiffness
    share = 1.0 / max(1.0 + capacity * stiffness, LEAST_CAPACITY)
    return share * rate, share * stiffness


@njit
def stiffness(volume: float, pressure: float, joint: Any) -> float:
    """Rise of the pressure for the oil that a volume takes, B/V [Pa/m^3]; air softens oil of a low pressure.

    Args:
        volume: [m^3].
        pressure: [Pa].
        joint: parameter record.
    """
    bulk_modulus = joint.fluid.bulk_modulus
    return bulk_modulus / (volume * (1.0 + bulk_modulus * hooks.compressibility(pressure, joint)))
