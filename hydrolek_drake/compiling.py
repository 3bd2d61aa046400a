"""How the physics is compiled."""

from typing import Any

import numba

COMPILED = {"error_model": "numpy"}
"""Divisions as numpy has them, see `njit`."""


def njit(*function: Any, **options: Any) -> Any:
    """Numba's `njit`, with divisions as numpy has them: by zero they give infinity or NaN.

    A rollout that divides by zero then leaves all bounds, which is a scored outcome, and a loop over machines in lanes
    has no exceptions that would keep it from vector instructions.
    """
    return numba.njit(*function, **{**COMPILED, **options})
