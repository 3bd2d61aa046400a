"""Actuators with two chambers: cylinder, equation (4.9), rotary vane and hydraulic motor; electric motor.

A vane actuator and a hydraulic motor are the same equations with a displacement [m^3/rad] in place of the
piston area and an angle in place of the stroke.
"""

from typing import Any

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import cavity
from hydrolek_drake.physics.fluid import softened, stiffness
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

    P_A' = B/V_A (Q_A - A_A v), P_B' = B/V_B (Q_B + A_B v); at zero and below see `cavity.rate`. A hose that widens
    takes oil besides.

    Args:
        p_a: pressure on side A, below zero a cavity [Pa].
        p_b: the same on side B [Pa].
        flow_a: oil flowing into side A [m^3/s].
        flow_b: oil flowing into side B [m^3/s].
        stroke: rod position [m].
        velocity: rod velocity, positive out [m/s].
        joint: parameter record.
    """
    p = joint.cylinder
    volume_a, volume_b = counted_volumes(stroke, joint)
    pressed_a, pressed_b = cavity.pressures(p_a, p_b, joint)
    stiffness_a = stiffness(volume_a, pressed_a, joint)
    stiffness_b = stiffness(volume_b, pressed_b, joint)
    if rare(joint) and joint.hose.variant != hose.NONE:
        more_a, more_b = hose.gives_way(joint)
        _, stiffness_a = softened(more_a, 0.0, stiffness_a)
        _, stiffness_b = softened(more_b, 0.0, stiffness_b)
    rate_a = stiffness_a * (flow_a - p.area_a * velocity)
    rate_b = stiffness_b * (flow_b + p.area_b * velocity)
    widening_a, widening_b = p.area_a * velocity / volume_a, -p.area_b * velocity / volume_b
    return (
        cavity.rate(p_a, rate_a, widening_a, joint),
        cavity.rate(p_b, rate_b, widening_b, joint),
        stiffness_a,
        stiffness_b,
    )


@njit
def pressure_force(p_a: float, p_b: float, joint: Any) -> float:
    """Force of the oil on the piston [N], A_A P_A - A_B P_B in (4.9)."""
    return joint.cylinder.area_a * p_a - joint.cylinder.area_b * p_b


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
