"""An actuator's own end stops: the hard one of (4.9), and those of a piston that give way."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.smooth import exponential, logarithm
from hydrolek_drake.physics.usual import rare

STOP_DEPTH = 1e-3
"""How deep a stop is pressed in where its stiffness counts as the rig has it, whatever its exponent [m]."""


@njit
def hard_stop_force(stroke: float, velocity: float, joint: Any) -> float:
    """Force of the cylinder's own end stops against the rod [N], F_C in (4.9)."""
    p = joint.cylinder
    if p.stop_penetration > 0.0:  # none where a variant has no such stops
        if stroke > p.stroke and velocity > 0.0:
            return (stroke - p.stroke) * p.stop_penetration * velocity
        if stroke < 0.0 and velocity < 0.0:
            return -stroke * p.stop_penetration * velocity
    return 0.0


@njit
def elastic_stop(stroke: float, velocity: float, joint: Any) -> float:
    """Force of the piston's elastic stops against the rod [N].

    Beyond each end of the stroke k s (s/s_0)^(n - 1) (1 + c v) + d v, a spring that hardens and loses energy with its
    force (Hunt and Crossley, J. Applied Mechanics 42 (1975) 440; c is 3/2 of their alpha), and a damper; they push back
    and never pull. At s_0 = 1 mm the force is k s_0.
    """
    if not has_elastic_stops(joint):
        return 0.0
    over = _beyond(stroke, joint)
    if over == 0.0:
        return 0.0
    spring = _stop_spring(over, joint)
    p = joint.cylinder
    force = spring + (abs(spring) * p.stop_dissipation + p.stop_damping) * velocity
    return force if force * over > 0.0 else 0.0


@njit
def slopes(stroke: float, velocity: float, h: float, joint: Any) -> tuple[float, float]:
    """Slopes of that force over velocity [N s/m] and over the stroke [N/m], where a piston at this speed is deepest.

    A step that only saw the slopes at its beginning would fly into a stop that it does not touch yet.

    Args:
        stroke: [m].
        velocity: [m/s].
        h: within so many seconds.
        joint: parameter record.
    """
    if not has_elastic_stops(joint):
        return 0.0, 0.0
    now, then = _beyond(stroke, joint), _beyond(stroke + h * velocity, joint)
    over = then if abs(then) > abs(now) else now
    if over == 0.0:
        return 0.0, 0.0
    spring = _stop_spring(over, joint)
    p = joint.cylinder
    pressed = 1.0 + max(p.stop_dissipation * velocity * over / abs(over), 0.0)
    return abs(spring) * p.stop_dissipation + p.stop_damping, p.stop_exponent * spring / over * pressed


@njit
def has_elastic_stops(joint: Any) -> bool:
    """Whether a piston has stops that give way."""
    p = joint.cylinder
    return rare(joint) and p.stop_stiffness > 0.0


@njit
def _beyond(stroke: float, joint: Any) -> float:
    """How far a piston is beyond its stroke [m], negative beyond its retracted end."""
    return max(stroke - joint.cylinder.stroke, 0.0) + min(stroke, 0.0)


@njit
def _stop_spring(over: float, joint: Any) -> float:
    """The part of a stop's force that does not depend on speed [N]."""
    p = joint.cylinder
    spring = p.stop_stiffness * over
    if p.stop_exponent > 1.0:
        spring *= exponential((p.stop_exponent - 1.0) * logarithm(abs(over) / STOP_DEPTH))
    return spring
