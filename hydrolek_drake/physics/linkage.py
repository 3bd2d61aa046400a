"""From joint angle to rod stroke and lever: triangle between two mounts, directly coupled, four-bar, or a table."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.angle import Angle, angle
from hydrolek_drake.physics.linkages import four_bar, lever_table
from hydrolek_drake.physics.parameters import Parameter, Stage
from hydrolek_drake.physics.usual import rare

STAGE = Stage(
    "linkage",
    "stroke and lever of the actuator at the joint",
    (
        Parameter(
            "mount_angle", "rad", "where the fixed mount stands around the joint axis (3-D arms)", neutral=0.0
        ),
        Parameter(
            "axial_offset",
            "m",
            "distance of the cylinder's plane from the joint along its axis (3-D arms)",
            neutral=0.0,
        ),
        Parameter(
            "play_inertia", "kg m^2|kg", "inertia on the cylinder's side of a play", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "play_stiffness", "N m/rad|N/m", "contact stiffness where a play closes", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "play_damping", "N m s/rad|N s/m", "contact damping where a play closes", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "play_taken_up",
            "1",
            "1 if a play starts in contact as the load presses, 0 if centred",
            neutral=1.0,
        ),
    ),
    {
        "triangle": (
            Parameter(
                "distance_parent",
                "m",
                "joint axis to the cylinder's mount on the fixed side, a",
                lowest=0.0,
                positive=True,
            ),
            Parameter(
                "distance_child",
                "m",
                "joint axis to the cylinder's mount on the moving side, b",
                lowest=0.0,
                positive=True,
            ),
            Parameter("angle_offset", "rad", "angle between the mounts at joint angle zero, phi"),
            Parameter(
                "direction", "1", "1 if extension raises the joint angle, else -1", lowest=-1.0, highest=1.0
            ),
            Parameter("zero_stroke_length", "m", "mount to mount with the rod fully in", lowest=0.0),
        ),
        "direct": (
            Parameter("zero_stroke_position", "rad|m", "joint position at zero stroke"),
            Parameter(
                "direction",
                "1",
                "1 if extension raises the joint position, else -1",
                lowest=-1.0,
                highest=1.0,
            ),
        ),
        "four_bar": four_bar.PARAMETERS,
        "lever_table": lever_table.PARAMETERS,
    },
)
TRIANGLE = float(STAGE.code("triangle"))
DIRECT = float(STAGE.code("direct"))
FOUR_BAR = float(STAGE.code("four_bar"))
LEVER_TABLE = float(STAGE.code("lever_table"))


@njit
def included_angle(position: float, joint: Any) -> float:
    """Angle between the two mounts as seen from the joint axis [rad], direction q + phi."""
    p = joint.linkage
    if p.variant == DIRECT or (rare(joint) and p.variant != TRIANGLE):
        return position
    return p.direction * position + p.angle_offset


@njit
def stroke_and_lever(position: float, joint: Any) -> tuple[float, float]:
    """Rod stroke [m] and lever ds/dq [m/rad] at a joint position, see `stroke_and_lever_at`."""
    return stroke_and_lever_at(angle(included_angle(position, joint)), position, joint)


@njit
def stroke_and_lever_at(included: Angle, position: float, joint: Any) -> tuple[float, float]:
    """Rod stroke [m] and lever ds/dq [m/rad] at a joint position and its `included_angle`.

    Triangle: L^2 = a^2 + b^2 - 2 a b cos(included angle), stroke = L - L(rod fully in), lever = direction a b
    sin(included angle)/L. The force of the rod times the lever is the moment on the joint (virtual work).
    """
    p = joint.linkage
    if p.variant == DIRECT:
        return p.direction * (position - p.zero_stroke_position), p.direction
    if rare(joint) and p.variant == FOUR_BAR:
        return four_bar.stroke_and_lever_of_four_bar(position, joint)
    if rare(joint) and p.variant == LEVER_TABLE:
        return lever_table.stroke_and_lever_of_table(position, joint)
    a = p.distance_parent
    b = p.distance_child
    length = math.sqrt(a * a + b * b - 2.0 * a * b * included.cosine)
    return length - p.zero_stroke_length, p.direction * a * b * included.sine / length


@njit
def play_torque(lead: float, lead_velocity: float, joint: Any) -> float:
    """Moment through a play [N m] when the cylinder's side leads the link by `lead` [rad].

    Nothing inside the gap; spring and damper where it is closed.
    """
    half = 0.5 * hooks.linkage_gap(joint)
    p = joint.linkage
    if lead > half:
        return p.play_stiffness * (lead - half) + p.play_damping * lead_velocity
    if lead < -half:
        return p.play_stiffness * (lead + half) + p.play_damping * lead_velocity
    return 0.0


@njit
def _pressed(lead: float, half: float) -> float:
    """By how much a play is pressed together beyond its gap [rad], below zero on the other side."""
    return lead - min(max(lead, -half), half)


@njit
def _pace(lead: float, before: float, free: float, halved: float, h: float, half: float, joint: Any) -> float:
    """Mean rate of the lead over a step [rad/s]: pace = v + h/2 (parting - yields mean), with the mean on that way.

    The mean does the work of the contact on the way, h pace mean = (after - before)(k/2 (before + after) + d pace).
    Within one side's contact that is linear in the pace (the implicit midpoint rule), where sides meet or part
    a quadratic, of which one root ends where the way was taken to end.

    Args:
        lead: towards the side that is in contact, or is being approached [rad].
        before: by how much that is pressed together [rad].
        free: pace without contact [rad/s].
        halved: half of `yields`, see `mean_play_torque`.
        h: step [s].
        half: of the play [rad].
        joint: parameter record.
    """
    p = joint.linkage
    stiff, damped = halved * p.play_stiffness, halved * p.play_damping
    squared = 1.0 + h * (
        0.5 * h * stiff + damped
    )  # coefficient of the pace's square where the way ends in contact
    if before == 0.0:
        if lead + h * free <= half:
            return free
        short = lead - half  # the sides meet
        linear, constant = h * stiff * short + damped * short - free, 0.5 * stiff * short * short
        return (math.sqrt(max(linear * linear - 4.0 * squared * constant, 0.0)) - linear) / (2.0 * squared)
    pace = (free - h * stiff * before) / squared
    if lead + h * pace >= half:
        return pace
    linear = -free - damped * before  # they part
    pace = -0.5 * (linear + math.sqrt(linear * linear + 2.0 * stiff * before * before))
    if lead + h * pace >= -half:
        return pace
    across = lead + half  # and meet on the other side
    linear = h * stiff * across + damped * (across - before) - free
    constant = 0.5 * stiff * (across * across - before * before)
    return -(linear + math.sqrt(max(linear * linear - 4.0 * squared * constant, 0.0))) / (2.0 * squared)


@njit
def mean_play_torque(
    lead: float, lead_velocity: float, parting: float, yields: float, h: float, joint: Any
) -> float:
    """Mean of `play_torque` over the `h` seconds to come [N m].

    The sides meet and part at any moment of a step, and the moment jumps there by the damping. On the straight way
    from the lead at its beginning to that at its end the moment has a mean in closed form (the discrete gradient of
    Gonzalez, Journal of Nonlinear Science 6, 1996): the share of the way in contact counts, so that the mean, and
    what a rollout makes of it, has a slope in all that says when the sides meet. The way is foretold with that mean
    itself, see `_pace`, so that a contact of any hardness gains no energy.

    Args:
        lead: of the cylinder's side [rad].
        lead_velocity: its rate [rad/s].
        parting: acceleration of the lead without contact [rad/s^2].
        yields: by how much a moment between the sides lessens it, sum of the reciprocals of both inertias
            [1/(kg m^2)].
        h: [s]; 0 for `play_torque` as it is now.
        joint: parameter record.
    """
    half = 0.5 * hooks.linkage_gap(joint)
    p = joint.linkage
    before = _pressed(lead, half)
    free = lead_velocity + 0.5 * h * parting
    side = math.copysign(1.0, before if before != 0.0 else free)
    pace = side * _pace(side * lead, side * before, side * free, 0.5 * yields, h, half, joint)
    way = h * pace
    if way == 0.0:
        return play_torque(lead, lead_velocity, joint)
    after = _pressed(lead + way, half)
    share = min(max((after - before) / way, 0.0), 1.0)
    return share * (0.5 * p.play_stiffness * (before + after) + p.play_damping * pace)
