"""Where one arm's joints bring its point and its tool, for compiled code (Tables 5.1 and 5.2)."""

import math
from typing import Any

from numba import njit


@njit(cache=True)
def wrapped(angle: float) -> float:
    """The same angle between -pi and pi."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@njit(cache=True)
def point_of(q: Any, links: Any, p: Any) -> None:
    """Thesis (5.3) for the chain: the point at joints 1 to 5, from the axis of joint 1, into `p`."""
    x, y, z = links[4, 0], links[4, 1], 0.0
    c, s = math.cos(q[4]), math.sin(q[4])
    x, y = links[3, 0] + c * x - s * y, links[3, 1] + s * x + c * y
    c, s = math.cos(q[3]), math.sin(q[3])
    x, z = c * x, -s * x
    x, y = links[2, 0] + x, links[2, 1] + y
    c, s = math.cos(q[2]), math.sin(q[2])
    x, y = links[1, 0] + c * x - s * y, links[1, 1] + s * x + c * y
    c, s = math.cos(q[1]), math.sin(q[1])
    x, y = links[0, 0] + c * x - s * y, links[0, 1] + s * x + c * y
    c, s = math.cos(q[0]), math.sin(q[0])
    p[0], p[1], p[2] = c * x + s * z, y, -s * x + c * z


@njit(cache=True)
def direction_of(q: Any, d: Any) -> None:
    """Direction of the tool at joints 1 to 5, the first column of R1 R2 R3 R4 R5, into `d`."""
    x, y = math.cos(q[4]), math.sin(q[4])
    z = -math.sin(q[3]) * x
    x = math.cos(q[3]) * x
    a = q[1] + q[2]
    c, s = math.cos(a), math.sin(a)
    x, y = c * x - s * y, s * x + c * y
    c, s = math.cos(q[0]), math.sin(q[0])
    d[0], d[1], d[2] = c * x + s * z, y, -s * x + c * z
