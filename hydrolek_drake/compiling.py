"""How the physics is compiled."""

from typing import Any

import numba

COMPILED = {"error_model": "numpy"}
"""Divisions as numpy has them, see `njit`."""


def njit(*function: Any, **options: Any) -> Any:
    """Numba's `njit`, with divisions as numpy has them: by zero they give infinity or NaN.

    A rollout that divides by zero then leaves all bounds, which is a scored outcome, and a loop over machines in lanes
    has no exceptions that would keep it from vector instructions.

    A function is part of those that call it, unless it is kept on disk for itself (`cache`): handing on two dozen
    numbers costs a third of a rollout, and one call that is left keeps a loop over lanes from vector instructions.
    Where that was left to the compiler's estimate, it depended on what the process had compiled before.
    """
    inlined = {"forceinline": not options.get("cache", False)}
    return numba.njit(*function, **{**COMPILED, **inlined, **options})
