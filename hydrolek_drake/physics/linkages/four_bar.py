"""A four-bar mechanism between cylinder and joint: an excavator's bucket, a bell crank."""

import math
from typing import Any

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.parameters import Parameter

PARAMETERS = (
    Parameter("ground", "m", "joint axis O to the crank's axis G", lowest=0.0, positive=True),
    Parameter("link_arm", "m", "joint axis O to the coupler's pin on the link", lowest=0.0, positive=True),
    Parameter("coupler", "m", "length of the coupler between link and crank", lowest=0.0, positive=True),
    Parameter(
        "crank_arm", "m", "crank's axis G to the coupler's pin on the crank", lowest=0.0, positive=True
    ),
    Parameter("link_angle", "rad", "from O-G to the link's arm at joint angle zero"),
    Parameter(
        "direction", "1", "1 if the joint angle turns the link's arm on, else -1", lowest=-1.0, highest=1.0
    ),
    Parameter(
        "assembly",
        "1",
        "1 if the crank's pin lies left of the way from G to the link's pin, else -1",
        lowest=-1.0,
        highest=1.0,
    ),
    Parameter("cylinder_arm", "m", "crank's axis G to the cylinder's pin", lowest=0.0, positive=True),
    Parameter("cylinder_angle", "rad", "from the crank's arm to the arm of the cylinder's pin"),
    Parameter("mount_x", "m", "cylinder's fixed mount, from G onwards along O-G"),
    Parameter("mount_y", "m", "the same, square to it, to the left"),
    Parameter("zero_stroke_length", "m", "mount to pin with the rod fully in", lowest=0.0),
)


STRAIGHT = 1e-3
"""A mechanism is kept open by this share of its crank, where crank and coupler would lie in one line."""


@njit
def stroke_and_lever_of_four_bar(position: float, joint: Any) -> tuple[float, float]:
    """Stroke [m] and lever ds/dq [m/rad] at a joint angle.

    In the plane with O at the origin and G on the first axis, the coupler joins the link's pin P and the crank's pin C:
    C lies where circles around G and P meet. No part changes its length, so that the velocities of P and C along the
    coupler are the same, which gives the crank's rate; the cylinder's is that of its pin along it (Uicker, Pennock,
    Shigley, Theory of Machines and Mechanisms, loop closure and velocity analysis). Where the circles do not meet, as a
    rig may not have it between its stops, the crank stands all but straight towards P.

    Args:
        position: of the joint [rad].
        joint: parameter record.
    """
    p = joint.linkage
    turned = p.direction * position + p.link_angle
    pin_x, pin_y = p.link_arm * math.cos(turned), p.link_arm * math.sin(turned)
    # from the crank's axis G
    x, y = pin_x - p.ground, pin_y
    far = max(math.sqrt(x * x + y * y), STRAIGHT * p.crank_arm)
    along = (p.crank_arm * p.crank_arm - p.coupler * p.coupler + far * far) / (2.0 * far)
    least = STRAIGHT * p.crank_arm
    across = p.assembly * math.sqrt(max(p.crank_arm * p.crank_arm - along * along, least * least))
    crank_x, crank_y = (along * x - across * y) / far, (along * y + across * x) / far
    # rates for each radian of the link's arm
    coupler_x, coupler_y = crank_x - x, crank_y - y
    pushed = pin_x * coupler_y - pin_y * coupler_x
    turns = pushed / (crank_x * coupler_y - crank_y * coupler_x)
    cosine, sine = math.cos(p.cylinder_angle), math.sin(p.cylinder_angle)
    share = p.cylinder_arm / p.crank_arm
    rod_x, rod_y = share * (crank_x * cosine - crank_y * sine), share * (crank_x * sine + crank_y * cosine)
    from_x, from_y = rod_x - p.mount_x, rod_y - p.mount_y
    length = max(math.sqrt(from_x * from_x + from_y * from_y), least)
    lever = p.direction * turns * (from_y * rod_x - from_x * rod_y) / length
    return length - p.zero_stroke_length, lever


def closes(link_arm: float, ground: float, coupler: float, crank_arm: float, turned: float) -> bool:
    """Whether a mechanism can be put together with the link's arm `turned` from O-G [rad]; lengths in m.

    Crank and coupler must not lie in one line, where nothing says which way they bend.
    """
    far = math.sqrt(link_arm**2 + ground**2 - 2.0 * link_arm * ground * math.cos(turned))
    if far <= 0.0:
        return False
    along = (crank_arm**2 - coupler**2 + far**2) / (2.0 * far)
    return bool(crank_arm**2 - along**2 > (STRAIGHT * crank_arm) ** 2)
