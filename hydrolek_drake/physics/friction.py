"""Dry friction, the same at all speeds or falling as a body starts to move, smoothed over a speed or held by bristles.

Surfaces meet in bristles, which bend before they slide (Dahl, A solid friction model, Aerospace Corporation TOR-158,
1968; LuGre: Canudas de Wit, Olsson, Astrom, Lischinsky, IEEE Transactions on Automatic Control 40 (1995) 419). How far
they are bent tells the share s of the dry friction at rest that acts:

    s' = (v - sqrt(v^2 + v_0^2) s / g(v)) / z_b

z_b is the deflection at which they slide at rest, g the friction at a speed over that at rest, v_0 the speed over
which the sign of the speed is smoothed: at a steady speed s = g v / sqrt(v^2 + v_0^2). With z_b -> 0 that is so at any
time, and a body at rest creeps; with v_0 -> 0 it is LuGre's model, which holds a body at rest and lets friction fall
over a way, not at once; with g = 1 it is Dahl's. LuGre's damping of the bristles, sigma_1 s' z_b, is told by the time
sigma_1 / sigma_0 of damping over stiffness.
"""

import math
from typing import NamedTuple

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, hyperbolic_tangent, logarithm

AT_REST = 1e-24
"""Squared ratio of speeds below which none has faded, whatever the exponent; a logarithm must not be of zero."""

GAUSSIAN = 2.0
"""Exponent of a fading whose square needs no logarithm."""

FURTHER = 1.001
"""The slope is told over a thousandth of the velocity, over which a friction's curve is straight."""


class Sliding(NamedTuple):
    """How two surfaces rub, for dry frictions of any level."""

    velocity: float  # of the body [m/s or rad/s]
    smooth: float  # speed below which the sign of the velocity is smoothed
    side: float  # to which bristles are fully bent, -1 or 1; 0 where there are none


@njit
def sign_of(at: Sliding) -> float:
    """Share of a dry friction that acts: tanh(v / smooth), or that of fully bent bristles."""
    return hyperbolic_tangent(at.velocity / at.smooth) if at.side == 0.0 else at.side


@njit
def coulomb_friction(at: Sliding, level: float) -> tuple[float, float]:
    """Friction and its secant slope over velocity (see valve_spool_stiction); 0 where bristles are fully bent.

    Args:
        at: how the surfaces rub.
        level: friction at speed [N or N m].
    """
    if level == 0.0:
        return 0.0, 0.0
    share = sign_of(at)
    if at.side != 0.0:
        return level * share, 0.0
    return level * share, level * share / at.velocity if abs(share) > 1e-3 else level / at.smooth


@njit
def stribeck(
    at: Sliding, coulomb: float, at_rest: float, fading: float, exponent: float
) -> tuple[float, float]:
    """Friction and its secant slope over velocity (see valve_spool_stiction).

    (coulomb + at_rest e^(-|v / fading|^exponent)) times the share that acts; Armstrong-Helouvry, Dupont, Canudas de
    Wit, Automatica 30 (1994) 1083, who tell of exponents from 1/2 to 2 and more: lubricants differ.

    Args:
        at: how the surfaces rub.
        coulomb: friction at speed [N or N m].
        at_rest: further friction near zero speed [N or N m].
        fading: speed over which that fades [m/s or rad/s].
        exponent: of the fading.
    """
    if coulomb == 0.0 and at_rest == 0.0:
        return 0.0, 0.0
    ratio = at.velocity / fading
    faded = ratio * ratio
    if exponent != GAUSSIAN:  # a power costs a third of a rollout
        faded = exponential(0.5 * exponent * logarithm(max(faded, AT_REST)))
    return coulomb_friction(at, coulomb + at_rest * exponential(-faded))


@njit
def slope_of_growth(friction: float, secant: float, further: float, velocity: float) -> float:
    """What the slope of dry friction is beyond its secant for a body that speeds up; it does not fall below zero.

    The secant holds a body that comes to rest, and lets go too late of one that breaks away: there friction changes no
    more with speed, or falls, and a step follows the body explicitly. A joint that sticks and slips errs half as much.

    Args:
        friction: at a velocity.
        secant: its slope there.
        further: friction at the velocity `FURTHER` times as large.
        velocity: not zero.
    """
    return max((further - friction) / ((FURTHER - 1.0) * velocity), 0.0) - secant


@njit
def _smoothed_size(velocity: float, smooth: float) -> tuple[float, float]:
    """Size of a velocity that does not fall below v_0, sqrt(v^2 + v_0^2), and its smoothed sign, v over that."""
    size = math.sqrt(velocity * velocity + smooth * smooth)
    return size, velocity / size


@njit
def bristle_rate(bent: float, velocity: float, fading: float, smooth: float, deflection: float) -> float:
    """Rate at which the share that acts changes [1/s].

    Args:
        bent: that share, of the friction at rest.
        velocity: of the body [m/s or rad/s].
        fading: friction at that speed over the one at rest.
        smooth: speed below which the sign of the velocity is smoothed.
        deflection: at which bristles slide at rest [m or rad].
    """
    size, _ = _smoothed_size(velocity, smooth)
    return (velocity - size * bent / fading) / deflection


@njit
def bent_after(
    bent: float, travel: float, h: float, fading: float, smooth: float, deflection: float
) -> float:
    """The share that acts after a way at a steady speed, which solves `bristle_rate` exactly.

    Args:
        bent: before.
        travel: way of the body [m or rad].
        h: time that it took [s].
        fading: as of `bristle_rate`.
        smooth: as of `bristle_rate`.
        deflection: as of `bristle_rate`.
    """
    if h <= 0.0:
        return bent
    size, share = _smoothed_size(travel / h, smooth)
    steady = share * fading
    return steady + (bent - steady) * exponential(-size * h / (fading * deflection))


@njit
def bending(
    bent: float, velocity: float, h: float, fading: float, smooth: float, deflection: float
) -> tuple[float, float]:
    """Mean rate of the share that acts within a step [1/s], and by how much it rises for each metre of its way.

    What a step sees of a reversal at speed, which bends bristles within less than it, is what it leads to. The second
    [1/m or 1/rad] is 0 where the share falls.

    Args:
        bent: at its beginning.
        velocity: there.
        h: step [s].
        fading: as of `bristle_rate`.
        smooth: as of `bristle_rate`.
        deflection: as of `bristle_rate`.
    """
    size, share = _smoothed_size(velocity, smooth)
    within = deflection + size * h / fading
    rate = bristle_rate(bent, velocity, fading, smooth, within)
    return rate, max(1.0 - bent * share / fading, 0.0) / within
