"""Cavities: a chamber that takes more oil than flows in has no pressure, and what it lacks comes in again first.

The state of a chamber is its pressure, and below zero the volume V_c of its cavity, as the pressure p = -B V_c/V that
the oil would take for it: p' = B/V (Q - A v) holds on both sides of zero, and what acts and flows is max(p, 0)
(continuity, Merritt, Hydraulic Control Systems, 1967, section 3.4; the cavity as that of a column that has separated,
Wylie, Streeter, Fluid Transients in Systems, 1993, chapter 8). `fluid.cavity_refilled` is the share of the cavity that
oil has to fill again: all of a cavity of vapour; none where a pressure is only held at zero, as simulators do, or where
air that came out of the oil takes its place.
"""

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
def rate(state: float, rising: float, joint: Any) -> float:
    """Rate of a chamber's state [Pa/s].

    Without cavities that are refilled a pressure does not fall below zero, and no faster towards it than
    `fluid.floor_time` allows.

    Args:
        state: pressure, below zero a cavity [Pa].
        rising: rate that the flows give it [Pa/s].
        joint: parameter record.
    """
    share = refilled(joint)
    if share > 0.0:
        grows = state <= 0.0 and rising < 0.0
        return share * rising if grows else rising
    time_constant = joint.fluid.floor_time
    if time_constant > 0.0:
        return max(rising, -state / time_constant)
    if state <= 0.0 and rising < 0.0:
        return 0.0
    return rising


@njit
def after_step(state: float, joint: Any) -> float:
    """A chamber's state at the end of a step: without cavities that are refilled none is below zero."""
    return state if are_refilled(joint) else max(state, 0.0)
