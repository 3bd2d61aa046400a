"""Equation of motion of turning links, one on another: M(q) q'' + c(q, q') = tau, with gravity in c.

The Diagram's arms are a MultibodyPlant; compiled simulations of whole arms have these recursions, and tests hold one
against the other. Everything is told in the axes of the base about its origin, where mass, first moment, inertia and
wrenches of several bodies are simply added (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 2, 5 and 6).
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from hydrolek_drake.physics.vectors import (
    Matrix,
    Vector,
    cross,
    dot,
    matrix_at,
    plus,
    product,
    put_at,
    rotation,
    scaled,
    second_at,
    turned,
    vector_at,
)

Body = tuple[float, float, float, float, float, float, float, float, float, float]
"""Mass, first moment, and inertia xx xy xz yy yz zz about the origin."""

ROOT = -1
"""Parent of a link that turns on the base."""


class Links(NamedTuple):
    """Links that turn, each after the one on which it turns; one row for each."""

    parent: np.ndarray  # row of the link on which it turns, or `ROOT`. # (n,) int
    turn: np.ndarray  # axes of its joint in the parent's, at joint angle zero. # (n, 3, 3)
    offset: np.ndarray  # from the parent's joint to its own, in the parent's axes [m]. # (n, 3)
    axis: np.ndarray  # about which it turns, in its own axes. # (n, 3)
    mass: np.ndarray  # [kg]. # (n,)
    moment: np.ndarray  # mass times centre of gravity from its joint [kg m]. # (n, 3)
    inertia: np.ndarray  # about its joint [kg m^2]. # (n, 3, 3)
    carries: np.ndarray  # 1 where a payload hangs, else 0. # (n,)
    tool: np.ndarray  # where it hangs, from its joint [m]. # (n, 3)
    gravity: np.ndarray  # in the base's axes [m/s^2]. # (3,)


class Scratch(NamedTuple):
    """Room for `motion_equation`, one row for each link."""

    turn: np.ndarray  # axes in those of the base, row by row. # (n, 9)
    place: np.ndarray  # of the joint. # (n, 3)
    rate: np.ndarray  # angular velocity, and velocity of what is at the origin. # (n, 6)
    change: np.ndarray  # their change without q'', less gravity. # (n, 6)
    screw: np.ndarray  # axis, and velocity of what is at the origin as it turns with 1 rad/s. # (n, 6)
    body: np.ndarray  # the link with all that it carries, as in `Body`. # (n, 10)
    wrench: np.ndarray  # torque about the origin, and force. # (n, 6)


def scratch(count: int) -> Scratch:
    """Room for so many links."""
    return Scratch(*[np.zeros((count, width)) for width in (9, 3, 6, 6, 6, 10, 6)])


@njit
def motion_equation(
    links: Links,
    q: np.ndarray,
    w: np.ndarray,
    payload: np.ndarray,
    s: Scratch,
    matrix: np.ndarray,
    bias: np.ndarray,
) -> None:
    """Mass matrix, and the moments that hold the speeds as they are, against gravity too.

    Args:
        links: what turns.
        q: joint angles [rad]. # (n,)
        w: joint speeds [rad/s]. # (n,)
        payload: that hangs on each link that carries one [kg]. # (n,)
        s: room.
        matrix: receives M [kg m^2], but for entries between links of two arms. # (n, n)
        bias: receives c [N m]. # (n,)
    """
    n = len(q)
    for k in range(n):
        _link(links, k, q[k], w[k], payload[k] * links.carries[k], s)
    for k in range(n - 1, -1, -1):
        b = s.body
        body = (b[k, 0], b[k, 1], b[k, 2], b[k, 3], b[k, 4], b[k, 5], b[k, 6], b[k, 7], b[k, 8], b[k, 9])
        turning, moving = _momentum(body, vector_at(s.screw, k), second_at(s.screw, k))
        bias[k] = dot(vector_at(s.screw, k), vector_at(s.wrench, k)) + dot(
            second_at(s.screw, k), second_at(s.wrench, k)
        )
        j = k
        while j != ROOT:
            matrix[j, k] = dot(vector_at(s.screw, j), turning) + dot(second_at(s.screw, j), moving)
            matrix[k, j] = matrix[j, k]
            j = links.parent[j]
        p = links.parent[k]
        if p != ROOT:
            for r in range(10):
                s.body[p, r] += s.body[k, r]
            for r in range(6):
                s.wrench[p, r] += s.wrench[k, r]


@njit
def _link(links: Links, k: int, angle: float, speed: float, hanging: float, s: Scratch) -> None:
    """Place, motion, inertia and wrench of one link, from those of the link on which it turns."""
    p = links.parent[k]
    turn: Matrix = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    place = w = v = a_w = (0.0, 0.0, 0.0)
    a_v = (-links.gravity[0], -links.gravity[1], -links.gravity[2])  # as if the base were accelerated upwards
    if p != ROOT:
        t = s.turn
        turn = (t[p, 0], t[p, 1], t[p, 2], t[p, 3], t[p, 4], t[p, 5], t[p, 6], t[p, 7], t[p, 8])
        place, w, v = vector_at(s.place, p), vector_at(s.rate, p), second_at(s.rate, p)
        a_w, a_v = vector_at(s.change, p), second_at(s.change, p)
    place = plus(place, turned(turn, vector_at(links.offset, k)))
    axis = vector_at(links.axis, k)
    turn = product(product(turn, matrix_at(links.turn, k)), rotation(axis, angle))
    z = turned(turn, axis)
    lever = cross(place, z)
    # S' = v x S: the motion of the links before carries the axis along
    a_w = plus(a_w, scaled(speed, cross(w, z)))
    a_v = plus(a_v, scaled(speed, plus(cross(w, lever), cross(v, z))))
    w = plus(w, scaled(speed, z))
    v = plus(v, scaled(speed, lever))
    body = _about_origin(links.mass[k], vector_at(links.moment, k), matrix_at(links.inertia, k), turn, place)
    if hanging > 0.0:
        body = _with_point(body, hanging, plus(place, turned(turn, vector_at(links.tool, k))))
    turning, moving = _momentum(body, w, v)
    rising, pushing = _momentum(body, a_w, a_v)
    for r in range(9):
        s.turn[k, r] = turn[r]
    for r in range(10):
        s.body[k, r] = body[r]
    put_at(s.place, k, 0, place)
    put_at(s.rate, k, 0, w)
    put_at(s.rate, k, 3, v)
    put_at(s.change, k, 0, a_w)
    put_at(s.change, k, 3, a_v)
    put_at(s.screw, k, 0, z)
    put_at(s.screw, k, 3, lever)
    put_at(s.wrench, k, 0, plus(rising, plus(cross(w, turning), cross(v, moving))))
    put_at(s.wrench, k, 3, plus(pushing, cross(w, moving)))


@njit
def _about_origin(mass: float, moment: Vector, inertia: Matrix, turn: Matrix, place: Vector) -> Body:
    """A link's mass, moment and inertia in the base's axes about its origin."""
    a, b, c = turned(turn, moment)
    half = product(turn, inertia)
    x, y, z = place
    # shift from the joint's place p: m (p.p 1 - p p') + 2 (h.p) 1 - h p' - p h'
    d = mass * (x * x + y * y + z * z) + 2.0 * (a * x + b * y + c * z)
    xx = half[0] * turn[0] + half[1] * turn[1] + half[2] * turn[2] + d - mass * x * x - 2.0 * a * x
    yy = half[3] * turn[3] + half[4] * turn[4] + half[5] * turn[5] + d - mass * y * y - 2.0 * b * y
    zz = half[6] * turn[6] + half[7] * turn[7] + half[8] * turn[8] + d - mass * z * z - 2.0 * c * z
    xy = half[0] * turn[3] + half[1] * turn[4] + half[2] * turn[5] - mass * x * y - a * y - b * x
    xz = half[0] * turn[6] + half[1] * turn[7] + half[2] * turn[8] - mass * x * z - a * z - c * x
    yz = half[3] * turn[6] + half[4] * turn[7] + half[5] * turn[8] - mass * y * z - b * z - c * y
    return mass, a + mass * x, b + mass * y, c + mass * z, xx, xy, xz, yy, yz, zz


@njit
def _with_point(body: Body, mass: float, place: Vector) -> Body:
    """A body with a mass at one point."""
    m, a, b, c, xx, xy, xz, yy, yz, zz = body
    x, y, z = place
    return (
        m + mass,
        a + mass * x,
        b + mass * y,
        c + mass * z,
        xx + mass * (y * y + z * z),
        xy - mass * x * y,
        xz - mass * x * z,
        yy + mass * (x * x + z * z),
        yz - mass * y * z,
        zz + mass * (x * x + y * y),
    )


@njit
def _momentum(body: Body, w: Vector, v: Vector) -> tuple[Vector, Vector]:
    """Angular and linear momentum of a body about the origin."""
    m, a, b, c, xx, xy, xz, yy, yz, zz = body
    h = (a, b, c)
    spin = (
        xx * w[0] + xy * w[1] + xz * w[2],
        xy * w[0] + yy * w[1] + yz * w[2],
        xz * w[0] + yz * w[1] + zz * w[2],
    )
    return plus(spin, cross(h, v)), plus(scaled(m, v), cross(w, h))


def moments_along(
    links: Links, q: np.ndarray, w: np.ndarray, a: np.ndarray, payload: np.ndarray | None = None
) -> np.ndarray:
    """Moments that a motion needs, M(q) q'' + c(q, q') [N m]. # (k, n).

    Args:
        links: what turns.
        q: joint angles [rad]. # (k, n)
        w: joint speeds [rad/s]. # (k, n)
        a: joint accelerations [rad/s^2]. # (k, n)
        payload: that hangs on each link that carries one [kg]; None for none. # (k, n)
    """
    needed = np.zeros(q.shape)
    hanging = np.zeros(q.shape) if payload is None else payload
    moved = [np.ascontiguousarray(series, dtype=float) for series in (q, w, a)]
    _moments_along(links, *moved, hanging, scratch(q.shape[1]), needed)
    return needed


@njit(cache=True)
def _moments_along(
    links: Links,
    q: np.ndarray,
    w: np.ndarray,
    a: np.ndarray,
    payload: np.ndarray,
    s: Scratch,
    needed: np.ndarray,
) -> None:
    n = q.shape[1]
    matrix, bias = np.zeros((n, n)), np.empty(n)  # entries between two arms stay zero
    for k in range(len(q)):
        motion_equation(links, q[k], w[k], payload[k], s, matrix, bias)
        for i in range(n):
            needed[k, i] = bias[i]
            for j in range(n):
                needed[k, i] += matrix[i, j] * a[k, j]


@njit
def accelerations(matrix: np.ndarray, torque: np.ndarray) -> None:
    """Solve M q'' = tau in place, by Cholesky's factors of M, of which entries between links of two arms are zero.

    Args:
        matrix: M; overwritten. # (n, n)
        torque: tau; receives q''. # (n,)
    """
    n = len(torque)
    for j in range(n):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k]
        matrix[j, j] = np.sqrt(matrix[j, j])
        for i in range(j + 1, n):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
        for k in range(j):
            torque[j] -= matrix[j, k] * torque[k]
        torque[j] /= matrix[j, j]
    for j in range(n - 1, -1, -1):
        for k in range(j + 1, n):
            torque[j] -= matrix[k, j] * torque[k]
        torque[j] /= matrix[j, j]
