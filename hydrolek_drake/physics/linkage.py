"""From joint angle to rod stroke and lever: triangle between two mounts, or directly coupled."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics import hooks
from hydrolek_drake.physics.angle import Angle, angle
from hydrolek_drake.physics.parameters import Parameter, Stage

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
            "play_inertia", "kg m^2", "inertia on the cylinder's side of a play", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "play_stiffness", "N m/rad", "contact stiffness where a play closes", neutral=0.0, lowest=0.0
        ),
        Parameter(
            "play_damping", "N m s/rad", "contact damping where a play closes", neutral=0.0, lowest=0.0
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
    },
)
TRIANGLE = float(STAGE.code("triangle"))
DIRECT = float(STAGE.code("direct"))


@njit
def included_angle(position: float, joint: Any) -> float:
    """Angle between the two mounts as seen from the joint axis [rad], direction q + phi."""
    p = joint.linkage
    return position if p.variant == DIRECT else p.direction * position + p.angle_offset


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
