"""Dry friction, the same at all speeds or falling as a body starts to move."""

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, hyperbolic_tangent, logarithm

AT_REST = 1e-24
"""Squared ratio of speeds below which none has faded, whatever the exponent; a logarithm must not be of zero."""

GAUSSIAN = 2.0
"""Exponent of a fading whose square needs no logarithm."""

FURTHER = 1.001
"""The slope is told over a thousandth of the velocity, over which a friction's curve is straight."""


@njit
def coulomb_friction(velocity: float, level: float, smooth: float) -> tuple[float, float]:
    """Friction and its secant slope over velocity (see valve_spool_stiction): level tanh(v / smooth).

    Args:
        velocity: of the body [m/s or rad/s].
        level: friction at speed [N or N m].
        smooth: speed below which the sign of the velocity is smoothed [m/s or rad/s].
    """
    if level == 0.0:
        return 0.0, 0.0
    share = hyperbolic_tangent(velocity / smooth)
    return level * share, level * share / velocity if abs(share) > 1e-3 else level / smooth


@njit
def stribeck(
    velocity: float, coulomb: float, at_rest: float, fading: float, exponent: float, smooth: float
) -> tuple[float, float]:
    """Friction and its secant slope over velocity (see valve_spool_stiction).

    (coulomb + at_rest e^(-|v / fading|^exponent)) tanh(v / smooth); Armstrong-Helouvry, Dupont, Canudas de Wit,
    Automatica 30 (1994) 1083, who tell of exponents from 1/2 to 2 and more: lubricants differ.

    Args:
        velocity: of the body [m/s or rad/s].
        coulomb: friction at speed [N or N m].
        at_rest: further friction near zero speed [N or N m].
        fading: speed over which that fades [m/s or rad/s].
        exponent: of the fading.
        smooth: speed below which the sign of the velocity is smoothed [m/s or rad/s].
    """
    if coulomb == 0.0 and at_rest == 0.0:
        return 0.0, 0.0
    ratio = velocity / fading
    faded = ratio * ratio
    if exponent != GAUSSIAN:  # a power costs a third of a rollout
        faded = exponential(0.5 * exponent * logarithm(max(faded, AT_REST)))
    return coulomb_friction(velocity, coulomb + at_rest * exponential(-faded), smooth)


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
