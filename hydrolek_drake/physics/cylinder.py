"""Actuators with two chambers: cylinder, equation (4.9), rotary vane and hydraulic motor; electric motor.

A vane actuator and a hydraulic motor are the same equations with a displacement [m^3/rad] in place of the
piston area and an angle in place of the stroke.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import end_stops, hooks
from hydrolek_drake.physics.fluid import softened, stiffness
from hydrolek_drake.physics.friction import Sliding, bending, bent_after, bristle_rate
from hydrolek_drake.physics.lines import hose
from hydrolek_drake.physics.linkages import ball_screw, servo_screw
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.usual import rare

_CHAMBERS = (
    Parameter(
        "dead_volume_a", "m^3", "oil on side A at zero stroke, with its hose", lowest=0.0, positive=True
    ),
    Parameter(
        "dead_volume_b", "m^3", "oil on side B at full stroke, with its hose", lowest=0.0, positive=True
    ),
    Parameter(
        "initial_pressure_b", "Pa", "pressure on side B at the start; side A balances the load", lowest=0.0
    ),
)
_AREAS = (
    Parameter("area_a", "m^2", "piston area on the bore side, A_A in (4.9)", lowest=0.0, positive=True),
    Parameter("area_b", "m^2", "piston area on the rod side, A_B in (4.9)", lowest=0.0, positive=True),
)
_DISPLACEMENTS = (
    Parameter("area_a", "m^3/rad", "displacement of side A", lowest=0.0, positive=True),
    Parameter("area_b", "m^3/rad", "displacement of side B", lowest=0.0, positive=True),
)
_SMOOTHED = "below this Coulomb friction is smoothed"
_DAMPED = "damping of these bristles over their stiffness"
_BENT = "deflection at which the bristles of a dry friction slide, 0 for none: it is smoothed alone then"
_SLIDING_FRICTION = (
    Parameter("viscous_friction", "N s/m", "viscous friction of the seals, B_D in (4.9)", lowest=0.0),
    Parameter("friction_velocity", "m/s", _SMOOTHED, lowest=0.0, positive=True),
    Parameter("bristle_deflection", "m", _BENT, neutral=0.0, lowest=0.0),
    Parameter("bristle_time", "s", _DAMPED, neutral=0.0, lowest=0.0),
)
_TURNING_FRICTION = (
    Parameter("viscous_friction", "N m s/rad", "viscous friction of the seals", lowest=0.0),
    Parameter("friction_velocity", "rad/s", _SMOOTHED, lowest=0.0, positive=True),
    Parameter("bristle_deflection", "rad", _BENT, neutral=0.0, lowest=0.0),
    Parameter("bristle_time", "s", _DAMPED, neutral=0.0, lowest=0.0),
)
STAGE = Stage(
    "cylinder",
    "oil flow to force",
    (),
    {
        "cylinder": (
            *_AREAS,
            *_CHAMBERS,
            Parameter(
                "stroke", "m", "stroke over which side B's oil volume is counted, S in (4.9)", lowest=0.0
            ),
            *_SLIDING_FRICTION,
            Parameter("rod_mass", "kg", "rod and piston, M_R in (4.9)", neutral=0.0, lowest=0.0),
            Parameter(
                "stop_penetration",
                "N s/m^2",
                "hard stop's penetration coefficient, K_p in (4.9)",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter(
                "stop_stiffness",
                "N/m",
                "stiffness of the piston's stops at both ends of the stroke",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter("stop_damping", "N s/m", "damping of these stops", neutral=0.0, lowest=0.0),
            Parameter(
                "stop_exponent",
                "1",
                "of these stops' force over how deep they are pressed in: 1 for a spring, 1.5 for a round contact",
                neutral=1.0,
                lowest=1.0,
                highest=3.0,
            ),
            Parameter(
                "stop_dissipation",
                "s/m",
                "by which share for each m/s these stops press harder inwards than outwards",
                neutral=0.0,
                lowest=0.0,
            ),
            Parameter(
                "column_compliance",
                "m/N",
                "below this compliance the oil column of a chamber is not counted, 0 for any",
                neutral=0.0,
                lowest=0.0,
            ),
        ),
        "vane": (
            *_DISPLACEMENTS,
            *_CHAMBERS,
            Parameter("stroke", "rad", "travel over which side B's oil volume is counted", lowest=0.0),
            *_TURNING_FRICTION,
            Parameter(
                "stop_penetration",
                "N m s/rad^2",
                "hard stop's penetration coefficient",
                neutral=0.0,
                lowest=0.0,
            ),
        ),
        "hydraulic_motor": (*_DISPLACEMENTS, *_CHAMBERS, *_TURNING_FRICTION),
        "electric_motor": (Parameter("force_constant", "N/V", "force over command voltage", lowest=0.0),),
        "ball_screw": ball_screw.PARAMETERS,
        "servo_screw": servo_screw.PARAMETERS,
    },
)
CYLINDER = float(STAGE.code("cylinder"))
VANE = float(STAGE.code("vane"))
HYDRAULIC_MOTOR = float(STAGE.code("hydraulic_motor"))
ELECTRIC_MOTOR = float(STAGE.code("electric_motor"))
BALL_SCREW = float(STAGE.code("ball_screw"))
SERVO_SCREW = float(STAGE.code("servo_screw"))
FORCED = ("electric_motor", "ball_screw")
"""Variants without oil whose force the command gives."""

ELECTRIC = (*FORCED, "servo_screw")
"""Variants without oil."""


def electric(joints: np.ndarray) -> np.ndarray:
    """Which of some records, shape (n,), have no oil."""
    codes = [STAGE.code(variant) for variant in ELECTRIC]
    return np.asarray(np.isin(joints["cylinder"]["variant"], codes))


@njit
def is_electric(joint: Any) -> bool:
    """Whether an actuator has no oil."""
    p = joint.cylinder
    return p.variant == ELECTRIC_MOTOR or (
        rare(joint) and (p.variant == BALL_SCREW or p.variant == SERVO_SCREW)
    )


@njit
def follows_position(joint: Any) -> bool:
    """Whether a drive follows a commanded position."""
    return rare(joint) and joint.cylinder.variant == SERVO_SCREW


@njit
def chamber_volumes(stroke: float, joint: Any) -> tuple[float, float]:
    """Oil volumes on sides A and B [m^3]; a continuously turning motor keeps its dead volumes."""
    p = joint.cylinder
    if p.variant == HYDRAULIC_MOTOR:
        return p.dead_volume_a, p.dead_volume_b
    return (
        p.dead_volume_a + p.area_a * max(stroke, 0.0),
        p.dead_volume_b + p.area_b * max(p.stroke - stroke, 0.0),
    )


@njit
def counted_volumes(stroke: float, joint: Any) -> tuple[float, float]:
    """Oil volumes that give way to pressure on sides A and B [m^3], at least what a column's least compliance c has.

    The oil column of a chamber has the compliance V / (B A^2) (Merritt, Hydraulic Control Systems, 1967, section 6.1),
    so that V counts as B A^2 c at least. Simulators that join components by transmission lines keep their columns so
    soft, since a step h bears a mass m only with c >= h^2/(0.1 m) (Hopsan, HydraulicCylinderC: its least volumes);
    a real tube with its mounts gives way, too.
    """
    p = joint.cylinder
    volume_a, volume_b = chamber_volumes(stroke, joint)
    if rare(joint) and p.variant == CYLINDER and p.column_compliance > 0.0:
        least = joint.fluid.bulk_modulus * p.column_compliance
        volume_a = max(volume_a, least * p.area_a * p.area_a)
        volume_b = max(volume_b, least * p.area_b * p.area_b)
    return volume_a, volume_b


@njit
def pressure_rates(
    p_a: float, p_b: float, flow_a: float, flow_b: float, stroke: float, velocity: float, joint: Any
) -> tuple[float, float, float, float]:
    """Rates of the chamber pressures [Pa/s] and the chambers' stiffness B/V [Pa/m^3], from continuity.

    P_A' = B/V_A (Q_A - A_A v), P_B' = B/V_B (Q_B + A_B v); pressures do not fall below zero. A hose that widens
    takes oil besides.

    Args:
        p_a: pressure on side A [Pa].
        p_b: pressure on side B [Pa].
        flow_a: oil flowing into side A [m^3/s].
        flow_b: oil flowing into side B [m^3/s].
        stroke: rod position [m].
        velocity: rod velocity, positive out [m/s].
        joint: parameter record.
    """
    p = joint.cylinder
    volume_a, volume_b = counted_volumes(stroke, joint)
    stiffness_a = stiffness(volume_a, p_a, joint)
    stiffness_b = stiffness(volume_b, p_b, joint)
    if rare(joint) and joint.hose.variant != hose.NONE:
        more_a, more_b = hose.gives_way(joint)
        _, stiffness_a = softened(more_a, 0.0, stiffness_a)
        _, stiffness_b = softened(more_b, 0.0, stiffness_b)
    rate_a = stiffness_a * (flow_a - p.area_a * velocity)
    rate_b = stiffness_b * (flow_b + p.area_b * velocity)
    return _floored(p_a, rate_a, joint), _floored(p_b, rate_b, joint), stiffness_a, stiffness_b


@njit
def _floored(pressure: float, rate: float, joint: Any) -> float:
    """The rate with which a pressure may fall: none at zero, and no faster towards it than its time constant."""
    time_constant = joint.fluid.floor_time
    if time_constant > 0.0:
        return max(rate, -pressure / time_constant)
    if pressure <= 0.0 and rate < 0.0:
        return 0.0
    return rate


@njit
def pressure_force(p_a: float, p_b: float, joint: Any) -> float:
    """Force of the oil on the piston [N], A_A P_A - A_B P_B in (4.9)."""
    return joint.cylinder.area_a * p_a - joint.cylinder.area_b * p_b


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


@njit
def motor_force(voltage: float, joint: Any) -> float:
    """Force of one of the motors of `FORCED` [N]: force constant times command, or that of a ball screw."""
    if rare(joint) and joint.cylinder.variant == BALL_SCREW:
        return ball_screw.screw_force(voltage, joint)
    return joint.cylinder.force_constant * voltage


@njit
def motor_current(
    command: float, place: float, velocity: float, lag: float, deficit: float, joint: Any
) -> float:
    """Current of an electric motor [A] as `servo_screw.controlled` has it, or its command; 0 where it is not known."""
    if follows_position(joint):
        return servo_screw.controlled(command, place, velocity, lag, deficit, joint).current
    if rare(joint) and joint.cylinder.variant == BALL_SCREW:
        return ball_screw.commanded_current(command, joint)
    return 0.0
