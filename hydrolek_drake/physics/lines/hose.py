"""Hoses between valve and actuator: they widen with pressure, and take pressure for the flow; or long lines."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.lines import long_line
from hydrolek_drake.physics.parameters import Parameter, Stage

_SIDES = {"a": "port A", "b": "port B"}

STAGE = Stage(
    "hose",
    "hoses between valve and actuator, whose oil counts to the dead volumes; or long lines, whose oil does not",
    (),
    {
        "none": (),
        "hose": tuple(
            parameter
            for side, port in _SIDES.items()
            for parameter in (
                Parameter(
                    f"expansion_{side}",
                    "m^3/Pa",
                    f"volume that the hose of {port} gains with pressure",
                    neutral=0.0,
                    lowest=0.0,
                ),
                Parameter(
                    f"resistance_{side}",
                    "Pa s/m^3",
                    f"laminar pressure loss over flow of the hose of {port}, 128 nu rho l/(pi d^4)",
                    neutral=0.0,
                    lowest=0.0,
                ),
                Parameter(
                    f"loss_{side}",
                    "Pa s^2/m^6",
                    f"turbulent pressure loss over squared flow of the hose of {port} with its bends",
                    neutral=0.0,
                    lowest=0.0,
                ),
            )
        ),
        "long_line": long_line.PARAMETERS,
    },
    default="none",
)
NONE = float(STAGE.code("none"))
HOSE = float(STAGE.code("hose"))
LONG_LINE = float(STAGE.code("long_line"))


@njit
def gives_way(joint: Any) -> tuple[float, float]:
    """Volume that the lines of ports A and B gain beside the chambers' oil, for each pascal there [m^3/Pa]."""
    p = joint.hose
    if p.variant == LONG_LINE:
        a, b = long_line.pipes(joint)
        return 0.5 * a.capacity, 0.5 * b.capacity  # of the last half segments
    return p.expansion_a, p.expansion_b


@njit
def behind_hose(conductance: float, drop: float, resistance: float, loss: float) -> float:
    """Flow over pressure drop [m^3/(s Pa)] of an edge with a hose in series with it.

    The edge takes the drop Q^2/k^2 with k^2 = c^2 |dp|, the hose R Q + K Q^2 (Merritt, Hydraulic Control Systems, 1967,
    sections 3.2, 3.7); together dp = R Q + (K + 1/k^2) Q^2, of which Q/dp is the root.

    Args:
        conductance: of the edge at the whole pressure drop, c.
        drop: the whole pressure drop [Pa].
        resistance: R [Pa s/m^3].
        loss: K [Pa s^2/m^6].
    """
    if conductance <= 0.0 or resistance + loss <= 0.0:
        return conductance
    along = resistance * conductance
    return (
        2.0
        * conductance
        / (along + math.sqrt(along * along + 4.0 * (1.0 + loss * conductance**2 * abs(drop))))
    )


@njit
def through_hoses(
    conductances: tuple[float, float, float, float], p_supply: float, p_a: float, p_b: float, joint: Any
) -> tuple[float, float, float, float]:
    """Conductances of the edges P-A, A-T, P-B, B-T with the hoses in series [m^3/(s Pa)].

    Args:
        conductances: of the four edges.
        p_supply: pressure at port P [Pa].
        p_a: in chamber A [Pa].
        p_b: in chamber B [Pa].
        joint: parameter record.
    """
    pa, at, pb, bt = conductances
    p = joint.hose
    p_tank = joint.supply.tank_pressure
    return (
        behind_hose(pa, p_supply - p_a, p.resistance_a, p.loss_a),
        behind_hose(at, p_a - p_tank, p.resistance_a, p.loss_a),
        behind_hose(pb, p_supply - p_b, p.resistance_b, p.loss_b),
        behind_hose(bt, p_b - p_tank, p.resistance_b, p.loss_b),
    )
