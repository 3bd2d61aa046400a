"""A counterbalance valve, which is in no list, of every concealed machine."""

from typing import Any

from numba import njit

PILOT_RATIO = 3.0
"""Of pilot to held pressure, as catalogues give for booms that carry a steady load."""


@njit
def let_out(g: Any, p_held: float, p_pilot: float) -> float:
    """Share of the oil's way out of a held chamber that is open: the poppet opens in proportion to what lifts it.

    Args:
        g: the machine.
        p_held: in the chamber [Pa].
        p_pilot: in the other one [Pa].
    """
    lifted = min((p_held + PILOT_RATIO * p_pilot) / g.holding_pa, 1.0)
    return 1.0 - min(g.held, 1.0) * (1.0 - lifted)
