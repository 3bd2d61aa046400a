"""What opposes the rod: dry friction, which bristles may hold, seals, cushion and end stops (4.9)."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import end_stops, hooks
from hydrolek_drake.physics.friction import Sliding, bending, bent_after, bristle_rate
from hydrolek_drake.physics.usual import rare


@njit
def has_bristles(joint: Any) -> bool:
    """Whether bristles hold the rod's dry friction."""
    return rare(joint) and joint.cylinder.bristle_deflection > 0.0


@njit
def dry_friction(velocity: float, bent: float, h: float, joint: Any) -> tuple[float, float, float]:
    """Dry friction of the rod [N], its slope over velocity [N s/m], and its stiffness within a step [N/m].

    Args:
        velocity: of the rod, positive out [m/s].
        bent: share of the friction at rest that bristles hold, -1 to 1; without bristles it does not count.
        h: step [s].
        joint: parameter record.
    """
    p = joint.cylinder
    if not has_bristles(joint):
        friction, slope = hooks.rod_friction(Sliding(velocity, p.friction_velocity, 0.0), joint)
        return friction, slope, 0.0
    level = _fully_bent(0.0, bent, joint)
    if level == 0.0:
        return 0.0, 0.0, 0.0
    fading = _fading(velocity, joint)
    rate, rise = bending(bent, velocity, h, fading, p.friction_velocity, p.bristle_deflection)
    stiffness = abs(level) * rise
    damped = p.bristle_time * abs(level) * rate
    return abs(bent) * level + damped, p.bristle_time * stiffness, stiffness


@njit
def _fully_bent(velocity: float, side: float, joint: Any) -> float:
    """Dry friction of bristles that are fully bent to a side [N]."""
    friction, _ = hooks.rod_friction(Sliding(velocity, 0.0, 1.0 if side >= 0.0 else -1.0), joint)
    return friction


@njit
def _fading(velocity: float, joint: Any) -> float:
    """Dry friction at a velocity of the rod over that at rest; 1 where there is none."""
    at_rest = _fully_bent(0.0, velocity, joint)
    return _fully_bent(velocity, velocity, joint) / at_rest if at_rest != 0.0 else 1.0


@njit
def bent_on(bent: float, travel: float, h: float, joint: Any) -> float:
    """Share of the dry friction that bristles hold after the rod's way [m] within a step of `h` seconds."""
    if not has_bristles(joint) or _fully_bent(0.0, travel, joint) == 0.0:
        return bent
    p = joint.cylinder
    fading = _fading(travel / h if h > 0.0 else 0.0, joint)
    return bent_after(bent, travel, h, fading, p.friction_velocity, p.bristle_deflection)


@njit
def bent_rate(bent: float, velocity: float, joint: Any) -> float:
    """Rate of that share [1/s] at a velocity of the rod [m/s]."""
    if not has_bristles(joint):
        return 0.0
    p = joint.cylinder
    return bristle_rate(bent, velocity, _fading(velocity, joint), p.friction_velocity, p.bristle_deflection)


@njit
def friction_force(
    stroke: float, velocity: float, bent: float, h: float, time: float, joint: Any
) -> tuple[float, float, float]:
    """All that opposes the rod [N]: friction, cushion, end stops (4.9), with slope and stiffness of `dry_friction`.

    They are without those of elastic stops, which a step takes from `end_stops.slopes`. Arguments as of `dry_friction`,
    the stroke [m] and the time since switching on [s].
    """
    viscous = joint.cylinder.viscous_friction * hooks.viscous_gain(time, joint)
    friction, slope, stiffness = dry_friction(velocity, bent, h, joint)
    cushion, braking = hooks.rod_damping(velocity, stroke, joint)
    stop = end_stops.hard_stop_force(stroke, velocity, joint)
    elastic = end_stops.elastic_stop(stroke, velocity, joint)
    return (
        viscous * velocity + friction + cushion + stop + elastic,
        viscous + slope + braking,
        stiffness,
    )
