"""Faults of command and sensor that are in no list, of every concealed machine."""

import math
from typing import Any

from numba import njit

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Multiples of it fill the unit interval evenly and never repeat: commands are lost at no regular time."""


@njit
def lost(e: Any, t: float) -> bool:
    """Whether the command is lost at a time: once in every period, each time elsewhere in it."""
    turn = math.floor(t / e.lost_every_s)
    begin = (turn * GOLDEN) % 1.0 * (e.lost_every_s - e.lost_s)
    return 0.0 <= t - turn * e.lost_every_s - begin < e.lost_s


@njit
def worn(e: Any, share: float) -> float:
    """What a potentiometer that is worn around one place adds to its reading; `share` of the travel."""
    return e.worn_rad * math.exp(-(((share - e.worn_at) / e.worn_wide) ** 2))
