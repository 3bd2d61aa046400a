"""Pump and return line, shared by all joints."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter, Stage

STAGE = Stage(
    "supply",
    "pump and return line, shared by all joints",
    (
        Parameter("pressure", "Pa", "pump pressure, P_S", lowest=0.0),
        Parameter("tank_pressure", "Pa", "return line pressure, P_T", lowest=0.0),
        Parameter(
            "flow_time_constant",
            "s",
            "how fast the supply pressure answers to the flow drawn",
            lowest=0.0,
            positive=True,
        ),
    ),
    {"constant_pressure": ()},
)


@njit
def supply_pressure(flow: float, joint: Any) -> float:
    """Pressure at the valves [Pa] for a flow drawn by all joints together [m^3/s]."""
    return max(joint.supply.pressure - hooks.supply_drop(flow, joint), joint.supply.tank_pressure)


@njit
def flow_rate_of_change(flow: float, drawn: float, joint: Any) -> float:
    """Rate of the flow that the supply feels [m^3/s^2]: the drawn flow, low-passed."""
    return (drawn - flow) / joint.supply.flow_time_constant
