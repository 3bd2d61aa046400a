"""How far the edges of a valve are open at a place of its spool: overlap, rounding, notches, travel."""

import math
from typing import Any, NamedTuple

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.usual import rare
from hydrolek_drake.physics.valves.opening_table import tabled
from hydrolek_drake.physics.valves.variants import FLOW_MAP, FOUR_EDGES, PUMP_CONTROLLED


class Openings(NamedTuple):
    """How far the edges are open, shares of their full opening (0 to 1)."""

    pa: float
    at: float
    pb: float
    bt: float


@njit
def openings(x: float, joint: Any) -> Openings:
    """How far the edges are open at spool position `x` [m].

    Between the overlaps the valve is closed: the dead-zone. `land_shift` moves the spool's null without
    changing the slope of the opening. But for a valve of four edges, both edges of a direction open alike.
    """
    p = joint.valve
    shift = hooks.land_shift(joint)
    if rare(joint) and p.variant == PUMP_CONTROLLED:
        towards_a, towards_b = max(x - shift, 0.0), max(shift - x, 0.0)
        towards_a, towards_b = min(towards_a / p.full_travel, 1.0), min(towards_b / p.full_travel, 1.0)
        return Openings(towards_a, towards_b, towards_b, towards_a)
    if rare(joint) and p.variant == FLOW_MAP:
        towards_a = _opened(x - (p.overlap_a + shift), p.full_travel - p.overlap_a)
        towards_b = _opened(-x - (p.overlap_b - shift), p.full_travel - p.overlap_b)
        return Openings(towards_a, towards_b, towards_b, towards_a)
    if rare(joint) and p.variant == FOUR_EDGES:
        return Openings(
            tabled(
                _opened(
                    _rounded(x - (p.overlap_pa + shift), p.edge_rounding),
                    p.full_opening - p.overlap_pa,
                ),
                p.share_pa_quarter,
                p.share_pa_half,
                p.share_pa_three_quarters,
            ),
            tabled(
                _opened(
                    _rounded(-x - (p.overlap_at - shift), p.edge_rounding),
                    p.full_opening - p.overlap_at,
                ),
                p.share_at_quarter,
                p.share_at_half,
                p.share_at_three_quarters,
            ),
            tabled(
                _opened(
                    _rounded(-x - (p.overlap_pb - shift), p.edge_rounding),
                    p.full_opening - p.overlap_pb,
                ),
                p.share_pb_quarter,
                p.share_pb_half,
                p.share_pb_three_quarters,
            ),
            tabled(
                _opened(
                    _rounded(x - (p.overlap_bt + shift), p.edge_rounding),
                    p.full_opening - p.overlap_bt,
                ),
                p.share_bt_quarter,
                p.share_bt_half,
                p.share_bt_three_quarters,
            ),
        )
    towards_a = _opened(x - (p.overlap_a + shift), p.full_opening_a - p.overlap_a)
    towards_b = _opened(-x - (p.overlap_b - shift), p.full_opening_b - p.overlap_b)
    return Openings(towards_a, towards_b, towards_b, towards_a)


@njit
def _rounded(beyond: float, radius: float) -> float:
    """Opening of an edge that is `beyond` its overlap [m].

    Edges are rounded and run with a clearance, so that one opens by sqrt(x^2 + r^2) - r: with the square of its travel
    at first and, beyond some radii, by its travel less the radius (McCloy, Martin, Control of Fluid Power, 1980). What
    is closed stays so.
    """
    return math.sqrt(beyond * beyond + radius * radius) - radius if beyond > 0.0 and radius > 0.0 else beyond


@njit
def widened(opened: Openings, more: float) -> Openings:
    """Openings that are larger by a share."""
    by = 1.0 + more
    return Openings(by * opened.pa, by * opened.at, by * opened.pb, by * opened.bt)


@njit
def _opened(beyond: float, travel: float) -> float:
    """Share of full opening of a land that is `beyond` its overlap, out of the `travel` to full opening [m]."""
    per_travel = 1.0 / travel  # the same in both stages of a step
    return min(max(beyond * per_travel, 0.0), 1.0) if beyond > 0.0 else 0.0
