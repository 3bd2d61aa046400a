"""A valve by its measured flow map: flow of an edge over spool travel and pressure drop."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

OPENINGS = (20, 40, 60, 80, 100)
"""Shares of the way from the overlap to the full travel at which flows are given [%]; at the overlap none flows."""

DROPS = ("low", "middle", "high")
"""Pressure drops of one edge at which flows are given."""

PARAMETERS: tuple[Parameter, ...] = (
    Parameter("full_travel", "m", "spool travel at the last column of the map", lowest=0.0, positive=True),
    *(
        Parameter(
            f"drop_{drop}", "Pa", f"the map's {drop} pressure drop of one edge", lowest=0.0, positive=True
        )
        for drop in DROPS
    ),
    *(
        Parameter(
            f"flow_{side}_{opening}_{drop}",
            "m^3/s",
            f"flow of one edge, {opening} % of the way from overlap to full travel to {side.upper()}, {drop} drop",
            lowest=0.0,
        )
        for side in "ab"
        for opening in OPENINGS
        for drop in DROPS
    ),
)


@njit
def _over_travel(u: float, f20: float, f40: float, f60: float, f80: float, f100: float) -> float:
    """Flow at a share `u` of the travel, on straight lines from none at 0 to the last at 1."""
    v = 5.0 * u
    return (
        f20 * min(v, 1.0)
        + (f40 - f20) * min(max(v - 1.0, 0.0), 1.0)
        + (f60 - f40) * min(max(v - 2.0, 0.0), 1.0)
        + (f80 - f60) * min(max(v - 3.0, 0.0), 1.0)
        + (f100 - f80) * min(max(v - 4.0, 0.0), 1.0)
    )


@njit
def flows_towards_a(travelled: float, joint: Any) -> tuple[float, float, float]:
    """Flows of an edge at the three drops [m^3/s], at a share of the way to the full travel towards A."""
    p = joint.valve
    return (
        _over_travel(
            travelled,
            p.flow_a_20_low,
            p.flow_a_40_low,
            p.flow_a_60_low,
            p.flow_a_80_low,
            p.flow_a_100_low,
        ),
        _over_travel(
            travelled,
            p.flow_a_20_middle,
            p.flow_a_40_middle,
            p.flow_a_60_middle,
            p.flow_a_80_middle,
            p.flow_a_100_middle,
        ),
        _over_travel(
            travelled,
            p.flow_a_20_high,
            p.flow_a_40_high,
            p.flow_a_60_high,
            p.flow_a_80_high,
            p.flow_a_100_high,
        ),
    )


@njit
def flows_towards_b(travelled: float, joint: Any) -> tuple[float, float, float]:
    """The same towards B."""
    p = joint.valve
    return (
        _over_travel(
            travelled,
            p.flow_b_20_low,
            p.flow_b_40_low,
            p.flow_b_60_low,
            p.flow_b_80_low,
            p.flow_b_100_low,
        ),
        _over_travel(
            travelled,
            p.flow_b_20_middle,
            p.flow_b_40_middle,
            p.flow_b_60_middle,
            p.flow_b_80_middle,
            p.flow_b_100_middle,
        ),
        _over_travel(
            travelled,
            p.flow_b_20_high,
            p.flow_b_40_high,
            p.flow_b_60_high,
            p.flow_b_80_high,
            p.flow_b_100_high,
        ),
    )


@njit
def mapped_conductance(flows: tuple[float, float, float], drop: float, joint: Any) -> float:
    """Flow over pressure drop of one edge [m^3/(s Pa)] by the map.

    Between its pressure drops the flow goes straight over the root of the drop, as an orifice's does; below the lowest
    it is an orifice, smooth through zero as `fluid.orifice_conductance`, above the highest the last line goes on.

    Args:
        flows: at the three drops, where the spool stands [m^3/s].
        drop: across the edge [Pa].
        joint: parameter record.
    """
    p = joint.valve
    low, middle, high = flows
    transition = joint.fluid.laminar_transition
    smooth = math.sqrt(drop * drop + transition * transition)
    root = math.sqrt(smooth)
    root_low, root_middle, root_high = (
        math.sqrt(p.drop_low),
        math.sqrt(p.drop_middle),
        math.sqrt(p.drop_high),
    )
    flow = low * min(root, root_low) / root_low
    flow += (middle - low) * min(max(root - root_low, 0.0), root_middle - root_low) / (root_middle - root_low)
    flow += (high - middle) * max(root - root_middle, 0.0) / (root_high - root_middle)
    return max(flow, 0.0) / smooth
