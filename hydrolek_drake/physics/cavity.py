"""Cavities: a chamber that takes more oil than flows in has no pressure, and what it lacks comes in again first.

The state of a chamber is its pressure, and below zero the volume V_c of its cavity, as the pressure p = -B V_c/V that
the oil would take for it. With the oil's volume V + V p/B continuity gives p' = B/V (Q - (1 + p/B) A v) there, and
what acts and flows is max(p, 0) (continuity, Merritt, Hydraulic Control Systems, 1967, section 3.4; the cavity as that
of a column that has separated, Wylie, Streeter, Fluid Transients in Systems, 1993, chapter 8). `fluid.cavity_refilled`
is the share of the cavity that oil has to fill again: all of a cavity of vapour; none where a pressure is only held at
zero, as simulators do, or where air that came out of the oil takes its place.
"""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks


@njit
def refilled(joint: Any) -> float:
    """Share of a cavity that oil has to fill again: as the rig has it, and an effect beside it; all of it at most."""
    return min(joint.fluid.cavity_refilled + hooks.cavity_refilled(joint), 1.0)


@njit
def are_refilled(joint: Any) -> bool:
    """Whether cavities have to be filled again."""
    return refilled(joint) > 0.0


@njit
def pressures(p_a: float, p_b: float, joint: Any) -> tuple[float, float]:
    """Pressures [Pa] of chambers in a state, of which those below zero are cavities."""
    return (max(p_a, 0.0), max(p_b, 0.0)) if are_refilled(joint) else (p_a, p_b)


@njit
def rate(state: float, rising: float, widening: float, joint: Any) -> float:
    """Rate of a chamber's state [Pa/s].

    What is not refilled of a cavity is forgotten while it grows. Without cavities that are refilled a pressure does not
    fall below zero, and no faster towards it than `fluid.floor_time` allows.

    Args:
        state: pressure, below zero a cavity [Pa].
        rising: rate that flow and piston give a chamber full of oil [Pa/s].
        widening: share of its volume by which the piston widens the chamber a second [1/s].
        joint: parameter record.
    """
    share = refilled(joint)
    if share > 0.0 and state < 0.0:
        return (share * rising if rising < 0.0 else rising) - state * widening
    time_constant = joint.fluid.floor_time
    held = rising
    if time_constant > 0.0:
        held = max(rising, -state / time_constant)
    elif state <= 0.0 and rising < 0.0:
        held = 0.0
    return share * rising + (1.0 - share) * held


@njit
def after_step(before: float, state: float, joint: Any) -> float:
    """A chamber's state at the end of a step [Pa]: of a cavity that began within it the share that is refilled.

    Args:
        before: state at the beginning of the step [Pa].
        state: as the step ends [Pa].
        joint: parameter record.
    """
    if state >= 0.0:
        return state
    share = refilled(joint)
    if before > 0.0:
        return share * state + 0.0  # 0 and not -0 without cavities
    return state if share > 0.0 else 0.0


@njit
def pulled(state: float, share: float, measured: float) -> float:
    """A chamber's state moved by a share towards what a gauge shows [Pa].

    A gauge that shows no pressure says nothing of how large a cavity is, and one that shows some says that there is
    none.

    Args:
        state: pressure, below zero a cavity [Pa].
        share: of the way.
        measured: pressure, 0 or less where none is told from zero; NaN for no value [Pa].
    """
    if not math.isfinite(measured) or (state < 0.0 and measured <= 0.0):
        return state
    moved = state + share * (measured - state)
    return moved if state < 0.0 else max(moved, 0.0)
