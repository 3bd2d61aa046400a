"""Parts that every concealed machine has in the same form: coils, a counterbalance valve, a play, hoses."""

import math
from typing import Any

from numba import njit

PILOT_RATIO = 3.0
"""Of pilot to held pressure, as catalogues give for booms that carry a steady load."""


@njit
def coil(e: Any, driven: float, current: float) -> tuple[float, float]:
    """Current that a solenoid feels [A], and its rate in a coil that takes time [A/s].

    Args:
        e: what is concealed.
        driven: current that the amplifier drives [A].
        current: in the coil [A].
    """
    if e.coil_s > 0.0:
        return current, (driven - current) / e.coil_s
    return driven, 0.0


@njit
def let_out(e: Any, p_held: float, p_pilot: float) -> float:
    """Share of the oil's way out of a held chamber that is open: the poppet opens in proportion to what lifts it.

    Args:
        e: what is concealed.
        p_held: in the chamber [Pa].
        p_pilot: in the other one [Pa].
    """
    lifted = min((p_held + PILOT_RATIO * p_pilot) / e.holding_pa, 1.0)
    return 1.0 - min(e.held, 1.0) * (1.0 - lifted)


@njit
def through_play(gap: float, stiffness: float, damping: float, lead: float, closing: float) -> float:
    """Moment that a play lets through [Nm].

    Args:
        gap: its whole width [rad].
        stiffness: where it is taken up [Nm/rad].
        damping: likewise [Nm s/rad].
        lead: of the cylinder's side [rad].
        closing: rate of the lead [rad/s].
    """
    half = 0.5 * gap
    if abs(lead) <= half:
        return 0.0
    return stiffness * (lead - math.copysign(half, lead)) + damping * closing


@njit
def snagging(e: Any, q: float, low: float, high: float) -> float:
    """Moment of hoses that have pulled tight, against positive angles [Nm].

    Args:
        e: what is concealed.
        q: angle [rad].
        low: lower end of the travel [rad].
        high: its upper end [rad].
    """
    return e.snag_nm_per_rad * max(q - low - e.snag_at * (high - low), 0.0)
