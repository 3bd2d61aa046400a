"""What the actuator moves: a link that turns or a mass that slides, with gravity, damping and end stops."""

from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.angle import Angle, angle
from hydrolek_drake.physics.cylinder import BALL_SCREW, SERVO_SCREW
from hydrolek_drake.physics.linkage import stroke_and_lever
from hydrolek_drake.physics.linkages.ball_screw import screw_mass
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.usual import rare

_ROTATING_STOPS = (
    Parameter("lower_stop", "rad", "where the lower end stop begins"),
    Parameter("upper_stop", "rad", "where the upper end stop begins"),
    Parameter("stop_stiffness", "N m/rad", "stiffness of the end stops", lowest=0.0),
    Parameter("stop_damping", "N m s/rad", "damping of the end stops", lowest=0.0),
)
_ROTATING = (
    Parameter("damping", "N m s/rad", "viscous damping of the joint", lowest=0.0),
    *_ROTATING_STOPS,
    Parameter("initial_position", "rad", "joint angle at the start, where the recording does not tell"),
    Parameter(
        "friction_velocity",
        "rad/s",
        "below this Coulomb friction of the load is smoothed",
        neutral=1.0,
        lowest=0.0,
        positive=True,
    ),
)
_PAYLOAD = (
    Parameter(
        "payload_inertia", "kg m^2/kg", "moment of inertia per kilogram of payload", neutral=0.0, lowest=0.0
    ),
    Parameter(
        "payload_gravity_cos", "N m/kg", "gravity moment at angle zero per kilogram of payload", neutral=0.0
    ),
    Parameter(
        "payload_gravity_sin", "N m/kg", "gravity moment at 90 deg per kilogram of payload", neutral=0.0
    ),
)
_MOMENTS = (
    Parameter("inertia", "kg m^2", "moment of inertia about the joint axis", lowest=0.0, positive=True),
    Parameter("gravity_cos", "N m", "gravity moment at joint angle zero", neutral=0.0),
    Parameter("gravity_sin", "N m", "gravity moment at joint angle 90 deg", neutral=0.0),
    *_PAYLOAD,
)
STAGE = Stage(
    "load",
    "what the actuator moves",
    (),
    {
        "rotating": (*_MOMENTS, *_ROTATING),
        "arm": (*_MOMENTS, *_ROTATING),
        "sliding": (
            Parameter("inertia", "kg", "moving mass", lowest=0.0, positive=True),
            Parameter("gravity_cos", "N", "constant force against the positive direction", neutral=0.0),
            Parameter("payload_inertia", "kg/kg", "1", neutral=1.0, lowest=0.0),
            Parameter("damping", "N s/m", "viscous friction of the guides", lowest=0.0),
            Parameter("lower_stop", "m", "where the lower end stop begins"),
            Parameter("upper_stop", "m", "where the upper end stop begins"),
            Parameter("stop_stiffness", "N/m", "stiffness of the end stops", lowest=0.0),
            Parameter("stop_damping", "N s/m", "damping of the end stops", lowest=0.0),
            Parameter("initial_position", "m", "position at the start, where the recording does not tell"),
            Parameter(
                "friction_velocity",
                "m/s",
                "below this Coulomb friction of the load is smoothed",
                neutral=1.0,
                lowest=0.0,
                positive=True,
            ),
        ),
        "link": (
            Parameter("mass", "kg", "of all that turns", lowest=0.0, positive=True),
            Parameter("centre_along", "m", "centre of mass along the link: level at joint angle zero"),
            Parameter(
                "centre_across",
                "m",
                "centre of mass across the link: upwards at joint angle zero",
                neutral=0.0,
            ),
            Parameter(
                "gyration_radius",
                "m",
                "radius of gyration about the centre of mass; length / sqrt(12) of a uniform link",
                lowest=0.0,
            ),
            Parameter("gravity", "m/s^2", "acceleration of gravity; 0 about an upright axis", lowest=0.0),
            *_PAYLOAD,
            *_ROTATING,
        ),
    },
)
ROTATING = float(STAGE.code("rotating"))
SLIDING = float(STAGE.code("sliding"))
ARM = float(STAGE.code("arm"))
LINK = float(STAGE.code("link"))


@njit
def gravity_load(position: float, time: float, joint: Any) -> float:
    """Gravity's moment (or force) against the positive direction [N m or N], see `gravity_load_at`."""
    return gravity_load_at(angle(position), time, joint)


@njit
def gravity_load_at(position: Angle, time: float, joint: Any) -> float:
    """Gravity's moment (or force) against the positive direction [N m or N].

    Everything beyond one moving joint is a rigid body that turns about a fixed axis, so the moment is
    exactly g_c cos q + g_s sin q; of a mass m with its centre at (x, y) it is m g (x cos q - y sin q).
    """
    p = joint.load
    if p.variant == SLIDING:
        return p.gravity_cos
    mass = hooks.payload(time, joint)
    own_along, own_across = gravity_moments(joint)
    along = own_along + mass * p.payload_gravity_cos
    across = own_across + mass * p.payload_gravity_sin
    return along * position.cosine + across * position.sine


@njit
def gravity_moments(joint: Any) -> tuple[float, float]:
    """Gravity's moment on the load alone at joint angle zero and at 90 deg [N m]."""
    p = joint.load
    if rare(joint) and p.variant == LINK:
        weight = p.mass * p.gravity
        return weight * p.centre_along, -weight * p.centre_across
    return p.gravity_cos, p.gravity_sin


@njit
def own_inertia(joint: Any) -> float:
    """Inertia of the load alone [kg m^2 or kg]; m (k^2 + x^2 + y^2) of a mass with its place and radius of gyration."""
    p = joint.load
    if rare(joint) and p.variant == LINK:
        k, x, y = p.gyration_radius, p.centre_along, p.centre_across
        return p.mass * (k * k + x * x + y * y)
    return p.inertia


@njit
def moving_inertia(time: float, joint: Any) -> float:
    """Inertia of the load with its payload [kg m^2 or kg]."""
    return own_inertia(joint) + hooks.payload(time, joint) * joint.load.payload_inertia


@njit
def stop_load(position: float, velocity: float, joint: Any) -> float:
    """Moment of the end stops on the load [N m]: stiffness times overtravel and damping times speed."""
    p = joint.load
    if position > p.upper_stop:
        return -p.stop_stiffness * (position - p.upper_stop) - p.stop_damping * velocity
    if position < p.lower_stop:
        return -p.stop_stiffness * (position - p.lower_stop) - p.stop_damping * velocity
    return 0.0


@njit
def stop_slope(position: float, joint: Any) -> float:
    """Damping of the end stops where they are touched [N m s/rad]."""
    p = joint.load
    if position > p.upper_stop or position < p.lower_stop:
        return p.stop_damping
    return 0.0


@njit
def passive_load(position: float, velocity: float, joint: Any) -> tuple[float, float]:
    """Damping, friction and end stops against the motion [N m or N], and their slope over velocity."""
    damping = joint.load.damping
    friction, slope = hooks.load_friction(velocity, joint)
    stop = stop_load(position, velocity, joint)
    return damping * velocity + friction - stop, damping + slope + stop_slope(position, joint)


@njit
def resisting_load(position: Angle, velocity: float, time: float, joint: Any) -> tuple[float, float]:
    """All that opposes the actuator at the joint [N m or N], and its slope over velocity."""
    passive, slope = passive_load(position.value, velocity, joint)
    return gravity_load_at(position, time, joint) + passive, slope


@njit
def reflected_rod_inertia(joint: Any) -> float:
    """Inertia of the moving rod at the joint [kg m^2]: M_R times the squared lever in mid-travel, (4.9).

    Of a ball screw it is the mass that its turning parts add to the nut's [kg].
    """
    if rare(joint) and (joint.cylinder.variant == BALL_SCREW or joint.cylinder.variant == SERVO_SCREW):
        return screw_mass(joint)
    mass = joint.cylinder.rod_mass
    if not mass > 0.0:
        return 0.0
    _, lever = stroke_and_lever(0.5 * (joint.load.lower_stop + joint.load.upper_stop), joint)
    return mass * lever * lever
