"""Closed form of one arm for a point and a tool direction, up to one unknown: joint 5.

With the target p (from the axis of joint 1) and the unit direction d of the tool, both in the base frame, and
g(q5) = x4 + x5 cos q5 - y5 sin q5, the thesis's chain (Tables 5.1 and 5.2) gives in the frame turned by joint 1

    d_z = -sin q4 cos q5,     p_z = -sin q4 g(q5).

Hence p cos q5 - d g lies in the arm's plane, which yields joint 1 for each joint 5; then follow joint 4 (two
branches), joint 2 + joint 3 from the direction, and the length that is left for link 2, which must be the
length it has. So a target is one root of one function of joint 5 for each branch.
"""

import math
from typing import Any

from numba import njit

from hydrolek_drake.kinematics.compiled_forward import wrapped


@njit(cache=True)
def posture(q5: float, branch: int, p: Any, d: Any, links: Any, q: Any) -> tuple[float, float]:
    """Joints 1 to 5 that give the direction `d`, and what then is amiss of the length of link 2.

    Args:
        q5: Joint 5 in rad.
        branch: Bit 0: joint 1 forwards or turned by 180 degrees; bit 1: joint 4 with positive or negative cosine.
        p: Target from the axis of joint 1, in m, shape (3,).
        d: Direction of the tool, unit vector, shape (3,).
        links: See `Chain.links`.
        q: Receives joints 1 to 5 in rad.

    Returns:
        Length amiss in m, and 1 - |sin q4|, which is negative where the direction cannot be had.
    """
    c5, s5 = math.cos(q5), math.sin(q5)
    g = links[3, 0] + links[4, 0] * c5 - links[4, 1] * s5
    y = links[3, 1] + links[4, 0] * s5 + links[4, 1] * c5
    q1 = math.atan2(-(p[2] * c5 - d[2] * g), p[0] * c5 - d[0] * g)
    if branch & 1:
        q1 += math.pi if q1 < 0.0 else -math.pi
    c1, s1 = math.cos(q1), math.sin(q1)
    p_x, p_z = c1 * p[0] - s1 * p[2], s1 * p[0] + c1 * p[2]
    d_x, d_z = c1 * d[0] - s1 * d[2], s1 * d[0] + c1 * d[2]
    s4 = -(d_z * c5 + p_z * g) / (c5 * c5 + g * g)  # both equations at once: defined even where one vanishes
    room = 1.0 - abs(s4)
    if room < 0.0:
        s4 = 1.0 if s4 > 0.0 else -1.0
    c4 = math.sqrt(max(0.0, 1.0 - s4 * s4))
    if branch & 2:
        c4 = -c4
    a = math.atan2(d[1], d_x) - math.atan2(s5, c4 * c5)
    ca, sa = math.cos(a), math.sin(a)
    w_x, w_y = links[2, 0] + c4 * g, links[2, 1] + y
    r_x = p_x - links[0, 0] - (ca * w_x - sa * w_y)
    r_y = p[1] - links[0, 1] - (sa * w_x + ca * w_y)
    q2 = math.atan2(r_y, r_x) - math.atan2(links[1, 1], links[1, 0])
    q[0] = q1
    q[1] = wrapped(q2)
    q[2] = wrapped(a - q2)
    q[3] = math.atan2(s4, c4)
    q[4] = q5
    return math.hypot(r_x, r_y) - math.hypot(links[1, 0], links[1, 1]), room
