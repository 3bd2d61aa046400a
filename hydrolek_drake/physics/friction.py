"""Dry friction that falls as a body starts to move."""

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, hyperbolic_tangent


@njit
def stribeck(
    velocity: float, coulomb: float, at_rest: float, fading: float, smooth: float
) -> tuple[float, float]:
    """Friction and its secant slope over velocity (see valve_spool_stiction).

    (coulomb + at_rest e^(-(v / fading)^2)) tanh(v / smooth); Armstrong-Helouvry, Dupont, Canudas de Wit, Automatica 30
    (1994) 1083.

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
    return level * share, level * share / velocity if abs(share) > 1e-3 else level / smooth
