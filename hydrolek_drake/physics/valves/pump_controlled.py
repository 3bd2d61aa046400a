"""A pump that moves the actuator without a valve: both its ports are the chambers."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.parameters import Parameter

PARAMETERS = (
    Parameter(
        "full_travel", "m", "travel of the pump's control piston at full flow", lowest=0.0, positive=True
    ),
    Parameter("full_flow", "m^3/s", "flow of the pump with its control piston fully out", lowest=0.0),
    Parameter("cross_leakage", "m^3/(s Pa)", "of the pump from port to port", neutral=0.0, lowest=0.0),
    Parameter("case_leakage", "m^3/(s Pa)", "of each port to the case", neutral=0.0, lowest=0.0),
    Parameter("charge_pressure", "Pa", "of the charge pump that feeds the lower side", lowest=0.0),
    Parameter(
        "charge_conductance",
        "m^3/(s Pa)",
        "flow over pressure drop between the lower side and the charge line, either way",
        lowest=0.0,
    ),
    Parameter("relief_pressure", "Pa", "of the relief valves from port to port", neutral=0.0, lowest=0.0),
    Parameter(
        "relief_conductance",
        "m^3/(s Pa)",
        "flow that they let over for each pascal above it; 0 without any",
        neutral=0.0,
        lowest=0.0,
    ),
    Parameter(
        "switching_difference",
        "Pa",
        "difference of the chamber pressures within which the lower side changes",
        lowest=0.0,
        positive=True,
    ),
)


@njit
def pumped_flows(
    given: float, p_a: float, p_b: float, time: float, cross: float, joint: Any
) -> tuple[float, float, float, float, float]:
    """Oil flowing into A, into B and drawn from the supply [m^3/s], and each chamber's total conductance.

    Closed circuit (Rahmfeld and Ivantysynova, Displacement controlled linear actuator with differential cylinder,
    2001): the pump moves D n x from B to A; its ports leak into each other and into the case; pilot-operated check
    valves connect the lower side with the charge line, which gives and takes what the rod makes the sides differ by; a
    check valve feeds each side that falls below the charge pressure, and relief valves let over what is too much.

    Args:
        given: flow over the full one, positive feeds A.
        p_a: in chamber A [Pa].
        p_b: in chamber B [Pa].
        time: since switching on [s].
        cross: further leakage past the piston [m^3/(s Pa)].
        joint: parameter record.
    """
    p = joint.valve
    given = given * p.full_flow * hooks.flow_gain(time, joint)
    lower_b = min(max(0.5 + (p_a - p_b) / p.switching_difference, 0.0), 1.0)
    to_a, to_b = p.charge_conductance * (1.0 - lower_b), p.charge_conductance * lower_b
    if p_a < p.charge_pressure:  # its check valve
        to_a = p.charge_conductance
    if p_b < p.charge_pressure:
        to_b = p.charge_conductance
    over_a = p.relief_conductance if p_a > p.relief_pressure else 0.0
    over_b = p.relief_conductance if p_b > p.relief_pressure else 0.0
    relieved = over_a * (p_a - p.relief_pressure) - over_b * (p_b - p.relief_pressure)
    p_tank = joint.supply.tank_pressure
    across = p.cross_leakage + cross
    return (
        given
        - relieved
        - across * (p_a - p_b)
        - p.case_leakage * (p_a - p_tank)
        + to_a * (p.charge_pressure - p_a),
        -given
        + relieved
        + across * (p_a - p_b)
        - p.case_leakage * (p_b - p_tank)
        + to_b * (p.charge_pressure - p_b),
        0.0,
        across + p.case_leakage + to_a + over_a,
        across + p.case_leakage + to_b + over_b,
    )
