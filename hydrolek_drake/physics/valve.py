"""The four-way directional valve, equations (4.7), (4.8) with overlap, for both directions; also edge by edge."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.fluid import orifice_conductance
from hydrolek_drake.physics.lines import hose
from hydrolek_drake.physics.lines.long_line import Source
from hydrolek_drake.physics.usual import rare
from hydrolek_drake.physics.valves import flow_map, load_holding, pump_controlled
from hydrolek_drake.physics.valves.openings import Openings
from hydrolek_drake.physics.valves.variants import (
    FLOW_MAP,
    FOUR_EDGES,
    PLAIN,
    PRESSURE_COMPENSATED,
    PUMP_CONTROLLED,
)


@njit
def flow_forces(p_supply: float, p_a: float, p_b: float, more: float, joint: Any) -> tuple[float, float]:
    """Forces [N] with which the oil would close the spool if it were wholly open towards A, and towards B.

    The steady-state flow force F = f A dp of each edge, f = 0.43 for a sharp one (Merritt, Hydraulic Control Systems,
    1967, section 5.6); towards A two are open, P-A and B-T, towards B P-B and A-T.

    Args:
        p_supply: pressure at port P [Pa].
        p_a: pressure at port A [Pa].
        p_b: pressure at port B [Pa].
        more: added to the rig's f.
        joint: parameter record.
    """
    p = joint.valve
    if p.variant != PLAIN or p.flow_force + more <= 0.0:
        return 0.0, 0.0
    share = p.flow_force + more
    p_tank = joint.supply.tank_pressure
    return (
        share * p.max_area_a * (abs(p_supply - p_a) + abs(p_b - p_tank)),
        share * p.max_area_b * (abs(p_supply - p_b) + abs(p_a - p_tank)),
    )


@njit
def edge_conductances(
    opened: Openings, p_supply: float, p_a: float, p_b: float, time: float, joint: Any
) -> tuple[float, float, float, float]:
    """Flow over pressure drop of the four edges P-A, A-T, P-B, B-T [m^3/(s Pa)], equations (4.7), (4.8).

    The largest area of one edge among four is its area gradient times its travel beyond the overlap.

    Args:
        opened: how far the edges are open.
        p_supply: pressure at port P [Pa].
        p_a: pressure at port A [Pa].
        p_b: pressure at port B [Pa].
        time: since switching on [s], for oil that warms up.
        joint: parameter record.
    """
    p = joint.valve
    p_tank = joint.supply.tank_pressure
    leak = hooks.edge_conductance(joint)
    gain = hooks.flow_gain(time, joint)
    pa = leak
    at = leak
    pb = leak
    bt = leak
    if p.variant == PLAIN:
        coefficient = p.discharge * gain
        choke = hooks.port_drop(joint)
        if opened.pa > 0.0:
            area, both = opened.pa * p.max_area_a, _in_series(opened.pa, choke)
            pa += orifice_conductance(area, p_supply - p_a, coefficient, joint, both)
            bt += orifice_conductance(area, p_b - p_tank, coefficient, joint, both)
        if opened.pb > 0.0:
            area, both = opened.pb * p.max_area_b, _in_series(opened.pb, choke)
            pb += orifice_conductance(area, p_supply - p_b, coefficient, joint, both)
            at += orifice_conductance(area, p_a - p_tank, coefficient, joint, both)
    elif p.variant == PRESSURE_COMPENSATED:
        if opened.pa > 0.0:
            pa += gain * _compensated_conductance(opened.pa, p_supply - p_a, joint)
            bt += gain * _return_conductance(opened.pa, p_b - p_tank, joint)
        if opened.pb > 0.0:
            pb += gain * _compensated_conductance(opened.pb, p_supply - p_b, joint)
            at += gain * _return_conductance(opened.pb, p_a - p_tank, joint)
    elif rare(joint) and p.variant == FOUR_EDGES:
        coefficient = p.discharge * gain
        choke = hooks.port_drop(joint)
        pa += _edge(opened.pa, p.area_gradient_pa, p.overlap_pa, p_supply - p_a, choke, coefficient, joint)
        bt += _edge(opened.bt, p.area_gradient_bt, p.overlap_bt, p_b - p_tank, choke, coefficient, joint)
        pb += _edge(opened.pb, p.area_gradient_pb, p.overlap_pb, p_supply - p_b, choke, coefficient, joint)
        at += _edge(opened.at, p.area_gradient_at, p.overlap_at, p_a - p_tank, choke, coefficient, joint)
    elif rare(joint) and p.variant == FLOW_MAP:
        if opened.pa > 0.0:
            flows = flow_map.flows_towards_a(opened.pa, joint)
            pa += gain * flow_map.mapped_conductance(flows, p_supply - p_a, joint)
            bt += gain * flow_map.mapped_conductance(flows, p_b - p_tank, joint)
        if opened.pb > 0.0:
            flows = flow_map.flows_towards_b(opened.pb, joint)
            pb += gain * flow_map.mapped_conductance(flows, p_supply - p_b, joint)
            at += gain * flow_map.mapped_conductance(flows, p_a - p_tank, joint)
    if rare(joint) and joint.holding.variant != load_holding.NONE:
        fed_a, fed_b = opened.pa > 0.0, opened.pb > 0.0
        pa, at, pb, bt = load_holding.with_load_held(
            (pa, at, pb, bt), fed_a, fed_b, p_supply, p_a, p_b, joint
        )
    if rare(joint) and joint.hose.variant == hose.HOSE:
        pa, at, pb, bt = hose.through_hoses((pa, at, pb, bt), p_supply, p_a, p_b, joint)
    return pa, at, pb, bt


@njit
def _in_series(opening: float, port_drop: float) -> float:
    """Drop over an edge and its port in series, over that of the edge.

    Both take the same flow Q, the edge with the drop dp_e ~ (Q / s)^2, the port with port_drop s^2 dp_e.
    """
    return 1.0 + port_drop * opening * opening


@njit
def _edge(
    opening: float,
    gradient: float,
    overlap: float,
    drop: float,
    port_drop: float,
    coefficient: float,
    joint: Any,
) -> float:
    """Conductance of one of four edges that is open by a share [m^3/(s Pa)]."""
    if opening <= 0.0:
        return 0.0
    area = opening * gradient * (joint.valve.full_opening - overlap)
    return orifice_conductance(area, drop, coefficient, joint, _in_series(opening, port_drop))


@njit
def chamber_flows(
    opened: Openings,
    p_supply: float,
    p_a: float,
    p_b: float,
    time: float,
    joint: Any,
    back_a: float = 0.0,
    back_b: float = 0.0,
) -> tuple[float, float, float, float, float]:
    """Oil flowing into A, into B and drawn from the supply [m^3/s], and each chamber's total conductance.

    Arguments as for `edge_conductances`, and by which share the ways from A and from B to the tank conduct more, as
    unknown inputs have it. Leakage past the piston is part of the flows; the conductances are what lets a chamber's
    pressure settle, for the integrator.
    """
    p_tank = joint.supply.tank_pressure
    if rare(joint) and joint.valve.variant == PUMP_CONTROLLED:
        return pump_controlled.pumped_flows(
            opened.pa - opened.pb, p_a, p_b, time, hooks.cross_conductance(joint), joint
        )
    pa, at, pb, bt = edge_conductances(opened, p_supply, p_a, p_b, time, joint)
    at *= max(1.0 + back_a, 0.0)
    bt *= max(1.0 + back_b, 0.0)
    cross = hooks.cross_conductance(joint)
    drawn_a = pa * (p_supply - p_a)
    drawn_b = pb * (p_supply - p_b)
    across = cross * (p_a - p_b)
    return (
        drawn_a - at * (p_a - p_tank) - across,
        drawn_b - bt * (p_b - p_tank) + across,
        drawn_a + drawn_b,
        pa + at + cross,
        pb + bt + cross,
    )


@njit
def port_sources(
    opened: Openings,
    p_supply: float,
    p_a: float,
    p_b: float,
    time: float,
    joint: Any,
    back_a: float = 0.0,
    back_b: float = 0.0,
) -> tuple[Source, Source, float]:
    """What ports A and B give to long lines, and the flow drawn from the supply [m^3/s].

    Arguments as for `chamber_flows`, with the pressures at the ports; leakage past the piston does not pass them.
    """
    p_tank = joint.supply.tank_pressure
    pa, at, pb, bt = edge_conductances(opened, p_supply, p_a, p_b, time, joint)
    at *= max(1.0 + back_a, 0.0)
    bt *= max(1.0 + back_b, 0.0)
    return (
        Source(pa * p_supply + at * p_tank, pa + at),
        Source(pb * p_supply + bt * p_tank, pb + bt),
        pa * (p_supply - p_a) + pb * (p_supply - p_b),
    )


@njit
def beside_lines(
    flow_a: float, flow_b: float, p_a: float, p_b: float, joint: Any
) -> tuple[float, float, float, float]:
    """Flows into chambers A and B [m^3/s] that long lines feed, with leakage past the piston, and its conductance."""
    cross = hooks.cross_conductance(joint)
    across = cross * (p_a - p_b)
    return flow_a - across, flow_b + across, cross, cross


@njit
def _compensated_conductance(opening: float, drop: float, joint: Any) -> float:
    """Meter-in: full flow whatever the load while the compensator has its pressure, an orifice below."""
    p = joint.valve
    if drop <= 0.0:  # the compensator's check valve
        return 0.0
    if drop >= p.compensator_pressure:
        return opening * p.full_flow / drop
    lowest = joint.fluid.laminar_transition
    return opening * p.full_flow / math.sqrt(p.compensator_pressure * max(drop, lowest))


@njit
def _return_conductance(opening: float, drop: float, joint: Any) -> float:
    """Meter-out: an orifice given by its flow coefficient, smooth through zero as in `orifice_conductance`."""
    transition = joint.fluid.laminar_transition
    return (
        opening * joint.valve.return_coefficient / math.sqrt(math.sqrt(drop * drop + transition * transition))
    )
