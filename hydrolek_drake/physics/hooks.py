"""The effects' contributions, composed per hook into one compiled function each.

A hook without any effect costs nothing; an effect that is off costs one comparison, since each function
returns at once at its neutral value.
"""

from collections.abc import Callable
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.effects.catalogue import EFFECTS

Compiled = Callable[..., Any]


def _functions(hook: str) -> list[Compiled]:
    return [effect.hooks[hook] for effect in EFFECTS.values() if hook in effect.hooks]


def _sum1(functions: list[Compiled]) -> Compiled:
    """Sum of functions (joint) -> float."""
    if not functions:
        return njit(lambda joint: 0.0)
    head, *rest = functions
    if not rest:
        return head
    tail = _sum1(rest)
    return njit(lambda joint: head(joint) + tail(joint))


def _sum2(functions: list[Compiled]) -> Compiled:
    """Sum of functions (value, joint) -> float."""
    if not functions:
        return njit(lambda value, joint: 0.0)
    head, *rest = functions
    if not rest:
        return head
    tail = _sum2(rest)
    return njit(lambda value, joint: head(value, joint) + tail(value, joint))


def _product2(functions: list[Compiled]) -> Compiled:
    """Product of functions (value, joint) -> float."""
    if not functions:
        return njit(lambda value, joint: 1.0)
    head, *rest = functions
    if not rest:
        return head
    tail = _product2(rest)
    return njit(lambda value, joint: head(value, joint) * tail(value, joint))


def _sum3(functions: list[Compiled]) -> Compiled:
    """Sum of functions (first, second, joint) -> float."""
    if not functions:
        return njit(lambda first, second, joint: 0.0)
    head, *rest = functions
    if not rest:
        return head
    tail = _sum3(rest)
    return njit(lambda first, second, joint: head(first, second, joint) + tail(first, second, joint))


def _friction2(functions: list[Compiled]) -> Compiled:
    """Sum of functions (velocity or `friction.Sliding`, joint) -> (force, slope)."""
    if not functions:
        return njit(lambda velocity, joint: (0.0, 0.0))
    head, *rest = functions
    if not rest:
        return head
    tail = _friction2(rest)

    @njit
    def both(velocity, joint):  # type: ignore[no-untyped-def]
        force, slope = head(velocity, joint)
        more_force, more_slope = tail(velocity, joint)
        return force + more_force, slope + more_slope

    return both


def _friction3(functions: list[Compiled]) -> Compiled:
    """Sum of functions (velocity, stroke, joint) -> (force, slope)."""
    if not functions:
        return njit(lambda velocity, stroke, joint: (0.0, 0.0))
    head, *rest = functions
    if not rest:
        return head
    tail = _friction3(rest)

    @njit
    def both(velocity, stroke, joint):  # type: ignore[no-untyped-def]
        force, slope = head(velocity, stroke, joint)
        more_force, more_slope = tail(velocity, stroke, joint)
        return force + more_force, slope + more_slope

    return both


command_delay = _sum1(_functions("command_delay"))
coil_gain = _product2(_functions("coil_gain"))
land_shift = _sum1(_functions("land_shift"))
spool_friction = _friction2(_functions("spool_friction"))
edge_conductance = _sum1(_functions("edge_conductance"))
port_drop = _sum1(_functions("port_drop"))
flow_gain = _product2(_functions("flow_gain"))
viscous_gain = _product2(_functions("viscous_gain"))
supply_drop = _sum2(_functions("supply_drop"))
pump_loss = _sum1(_functions("pump_loss"))
compressibility = _sum2(_functions("compressibility"))
cavity_refilled = _sum1(_functions("cavity_refilled"))
cross_conductance = _sum1(_functions("cross_conductance"))
rod_friction = _friction2(_functions("rod_friction"))
rod_damping = _friction3(_functions("rod_damping"))
load_friction = _friction2(_functions("load_friction"))
payload = _sum2(_functions("payload"))
reading_error = _sum3(_functions("reading_error"))
reading_play = _sum1(_functions("reading_play"))
linkage_gap = _sum1(_functions("linkage_gap"))
base_stiffness = _sum1(_functions("base_stiffness"))
base_inertia = _sum1(_functions("base_inertia"))
