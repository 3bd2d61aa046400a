"""Valves that hold a load between the directional valve and the cylinder: counterbalance, pilot-operated check."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.fluid import orifice_conductance
from hydrolek_drake.physics.parameters import Parameter, Stage

_AREA = (
    Parameter("area", "m^2", "orifice area of the open valve", lowest=0.0),
    Parameter("discharge", "1", "contraction coefficient of it", lowest=0.0),
    Parameter("pilot_ratio", "1", "area of the pilot over that of the seat", lowest=0.0),
    Parameter("full_rise", "Pa", "rise of pressure from the crack to fully open", lowest=0.0, positive=True),
    Parameter("at_a", "1", "1 if port A has one, 0 if not", neutral=1.0, lowest=0.0, highest=1.0),
    Parameter("at_b", "1", "1 if port B has one, 0 if not", neutral=0.0, lowest=0.0, highest=1.0),
)

STAGE = Stage(
    "holding",
    "valves that hold the load, between valve and actuator; oil passes freely towards the actuator",
    (),
    {
        "none": (),
        "counterbalance": (
            *_AREA,
            Parameter("setting", "Pa", "pressure of the load alone at which it cracks", lowest=0.0),
        ),
        "pilot_check": (
            *_AREA,
            Parameter(
                "cracking", "Pa", "pilot beyond the balance of its seat at which it cracks", lowest=0.0
            ),
        ),
    },
    default="none",
)
NONE = float(STAGE.code("none"))
COUNTERBALANCE = float(STAGE.code("counterbalance"))


@njit
def opened_share(load: float, back: float, pilot: float, joint: Any) -> float:
    """How far a holding valve is open towards the directional valve, 0 to 1.

    A counterbalance valve cracks where the load's pressure and the pilot's times its ratio reach the setting, p_load +
    R p_pilot = p_set; a pilot-operated check where the pilot lifts it off its seat, R p_pilot = p_load - p_back +
    p_crack (Vickers, Mobile Hydraulics Manual, chapters on pressure controls and check valves). Both open in
    proportion beyond that.

    Args:
        load: pressure in the actuator's chamber [Pa].
        back: pressure behind the valve, where the oil goes [Pa].
        pilot: pressure of the other port [Pa].
        joint: parameter record.
    """
    p = joint.holding
    if p.variant == COUNTERBALANCE:
        beyond = load + p.pilot_ratio * pilot - p.setting
    else:
        beyond = p.pilot_ratio * pilot - (load - back) - p.cracking
    return min(max(beyond / p.full_rise, 0.0), 1.0)


@njit
def held_back(
    conductance: float, load: float, back: float, pilot: float, present: float, joint: Any
) -> float:
    """Flow over pressure drop [m^3/(s Pa)] of an edge with a holding valve in series with it.

    The edge takes Q = c sqrt(dp dp_e) with the drop dp_e, the holding valve likewise; both take the same flow, and the
    drops add up: c c_h / sqrt(c^2 + c_h^2). Towards the actuator its check valve is open.

    Args:
        conductance: of the edge at the whole pressure drop, c.
        load: pressure in the actuator's chamber [Pa].
        back: pressure on the other side of the edge [Pa].
        pilot: pressure of the other port [Pa].
        present: 1 if the port has a holding valve.
        joint: parameter record.
    """
    if present <= 0.0 or load <= back or conductance <= 0.0:
        return conductance
    p = joint.holding
    area = opened_share(load, back, pilot, joint) * p.area
    valve = orifice_conductance(area, load - back, p.discharge, joint)
    if valve <= 0.0:
        return 0.0
    return conductance * valve / math.sqrt(conductance * conductance + valve * valve)


@njit
def with_load_held(
    conductances: tuple[float, float, float, float],
    fed_a: bool,
    fed_b: bool,
    p_supply: float,
    p_a: float,
    p_b: float,
    joint: Any,
) -> tuple[float, float, float, float]:
    """Conductances of the edges P-A, A-T, P-B, B-T with the holding valves in series [m^3/(s Pa)].

    The pilot is the other port: its chamber's pressure where no check valve stands between, or while it is fed; else
    the tank's, to which a port behind a closed check valve leaks down.

    Args:
        conductances: of the four edges.
        fed_a: whether the spool feeds port A.
        fed_b: whether it feeds port B.
        p_supply: pressure at port P [Pa].
        p_a: in chamber A [Pa].
        p_b: in chamber B [Pa].
        joint: parameter record.
    """
    pa, at, pb, bt = conductances
    p = joint.holding
    p_tank = joint.supply.tank_pressure
    pilot_of_a = p_b if fed_b or p.at_b <= 0.0 else p_tank
    pilot_of_b = p_a if fed_a or p.at_a <= 0.0 else p_tank
    return (
        held_back(pa, p_a, p_supply, pilot_of_a, p.at_a, joint),
        held_back(at, p_a, p_tank, pilot_of_a, p.at_a, joint),
        held_back(pb, p_b, p_supply, pilot_of_b, p.at_b, joint),
        held_back(bt, p_b, p_tank, pilot_of_b, p.at_b, joint),
    )
