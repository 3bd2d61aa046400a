"""Dry friction, the same at all speeds or falling as a body starts to move."""

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, hyperbolic_tangent


@njit
def coulomb_friction(velocity: float, level: float, smooth: float) -> tuple[float, float]:
    """Friction and its slope over velocity: level tanh(v / smooth).

    Args:
        velocity: of the body [m/s or rad/s].
        level: friction at speed [N or N m].
        smooth: speed below which the sign of the velocity is smoothed [m/s or rad/s].
    """
    if level == 0.0:
        return 0.0, 0.0
    share = hyperbolic_tangent(velocity / smooth)
    return level * share, level * (1.0 - share * share) / smooth


@njit
def stribeck(
    velocity: float, coulomb: float, at_rest: float, fading: float, smooth: float
) -> tuple[float, float]:
    """Friction and its slope over velocity, none where it falls.

    (coulomb + at_rest e^(-(v / fading)^2)) tanh(v / smooth); Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30
    (1994) 1083. With the secant in place of the slope a step lets go too late of a body that breaks away; where
    friction falls the body runs away, which a step follows explicitly.

    Args:
        velocity: of the body [m/s or rad/s].
        coulomb: friction at speed [N or N m].
        at_rest: further friction near zero speed [N or N m].
        fading: speed over which that fades [m/s or rad/s].
        smooth: speed below which the sign of the velocity is smoothed [m/s or rad/s].
    """
    if coulomb == 0.0 and at_rest == 0.0:
        return 0.0, 0.0
    share = hyperbolic_tangent(velocity / smooth)
    ratio = velocity / fading
    level = coulomb + at_rest * exponential(-ratio * ratio)
    falling = 2.0 * (level - coulomb) * ratio / fading * share
    return level * share, max(level * (1.0 - share * share) / smooth - falling, 0.0)
