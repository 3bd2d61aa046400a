"""Equation of motion of turning links, one on another: M(q) q'' + c(q, q') = tau, with gravity in c.

The Diagram's arms are a MultibodyPlant; compiled simulations of whole arms have these recursions, and tests hold one
against the other. Everything is told in the axes of the base about its origin, where mass, first moment, inertia and
wrenches of several bodies are simply added (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 2, 5 and 6).
"""

import numpy as np

from hydrolek_drake.compiling import njit
from hydrolek_drake.physics.bodies.mass_matrix import ROOT, moments_of, parent_of
from hydrolek_drake.physics.bodies.vectors import (
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
    turned,
    vector_at,
)

Body = tuple[float, float, float, float, float, float, float, float, float, float]
"""Mass, first moment, and inertia xx xy xz yy yz zz about the origin."""

TURN, OFFSET, AXIS, MASS, MOMENT, INERTIA, CARRIES, TOOL, GRAVITY = (
    1, 10, 13, 16, 17, 20, 29, 30, 33,
)  # fmt: skip
"""Where a link's numbers begin in its row, see `link`."""

LINK_SIZE = 36

_TURN, _PLACE, _W, _V, _CHANGE_W, _CHANGE_V, _SCREW_W, _SCREW_V, _BODY, _TORQUE, _FORCE = (
    0, 9, 12, 15, 18, 21, 24, 27, 30, 40, 43,
)  # fmt: skip
"""Where a link's turn, place, velocities and so on begin in its row of `scratch`."""

_SCRATCH_SIZE = 46


def link(
    parent: int,
    turn: np.ndarray,
    offset: np.ndarray,
    axis: np.ndarray,
    mass: float,
    moment: np.ndarray,
    inertia: np.ndarray,
    gravity: np.ndarray,
    tool: np.ndarray | None = None,
) -> np.ndarray:
    """A link's numbers in a row, as compiled code takes them: one array is handed on for less than ten. # (36,).

    Args:
        parent: row of the link on which it turns, which comes before it, or `ROOT`.
        turn: axes of its joint in the parent's, at joint angle zero. # (3, 3)
        offset: from the parent's joint to its own, in the parent's axes [m]. # (3,)
        axis: about which it turns, in its own axes, a unit vector. # (3,)
        mass: [kg].
        moment: mass times centre of gravity from its joint [kg m]. # (3,)
        inertia: about its joint [kg m^2]. # (3, 3)
        gravity: in the base's axes [m/s^2]. # (3,)
        tool: where a payload hangs, from its joint [m]; None where none does. # (3,)
    """
    hangs = np.zeros(4) if tool is None else np.append(1.0, tool)
    parts = (parent, np.ravel(turn), offset, axis, mass, moment, np.ravel(inertia), hangs, gravity)
    return np.concatenate([np.atleast_1d(np.asarray(part, dtype=float)) for part in parts])


def scratch(count: int) -> np.ndarray:
    """Room for `motion_equation` of so many links. # (count, 46)."""
    return np.zeros((count, _SCRATCH_SIZE))


@njit
def motion_equation(
    links: np.ndarray,
    sine: np.ndarray,
    cosine: np.ndarray,
    w: np.ndarray,
    payload: np.ndarray,
    s: np.ndarray,
    matrix: np.ndarray,
    bias: np.ndarray,
) -> None:
    """Mass matrix, and the moments that hold the speeds as they are, against gravity too.

    What it does depends on the links alone, so that it can be compiled for numbers of many arms at once
    (`rollout.lanes.numbers`).

    Args:
        links: what turns, rows of `link`. # (n, 36)
        sine: of the joint angles. # (n,)
        cosine: of the joint angles. # (n,)
        w: joint speeds [rad/s]. # (n,)
        payload: that hangs on each link that carries one [kg]. # (n,)
        s: `scratch`. # (n, 46)
        matrix: receives M [kg m^2], but for entries between links of two arms. # (n, n)
        bias: receives c [N m]. # (n,)
    """
    n = len(links)
    for k in range(n):
        _put_link(links, k, sine[k], cosine[k], w[k], payload[k], s)
    for k in range(n - 1, -1, -1):
        z, lever = vector_at(s, k, _SCREW_W), vector_at(s, k, _SCREW_V)
        turning, moving = _momentum(_body_at(s, k), z, lever)
        bias[k] = dot(z, vector_at(s, k, _TORQUE)) + dot(lever, vector_at(s, k, _FORCE))
        j = k
        while j != ROOT:
            matrix[j, k] = dot(vector_at(s, j, _SCREW_W), turning) + dot(vector_at(s, j, _SCREW_V), moving)
            matrix[k, j] = matrix[j, k]
            j = parent_of(links, j)
        p = parent_of(links, k)
        if p != ROOT:
            for r in range(_BODY, _SCRATCH_SIZE):
                s[p, r] += s[k, r]


@njit
def _put_link(
    links: np.ndarray, k: int, sine: float, cosine: float, speed: float, hanging: float, s: np.ndarray
) -> None:
    """Place, motion, inertia and wrench of one link, from those of the link on which it turns."""
    p = parent_of(links, k)
    turn: Matrix = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    place = w = v = a_w = (0.0, 0.0, 0.0)
    a_v = scaled(-1.0, vector_at(links, k, GRAVITY))  # as if the base were accelerated upwards
    if p != ROOT:
        turn = matrix_at(s, p, _TURN)
        place, w, v = vector_at(s, p, _PLACE), vector_at(s, p, _W), vector_at(s, p, _V)
        a_w, a_v = vector_at(s, p, _CHANGE_W), vector_at(s, p, _CHANGE_V)
    place = plus(place, turned(turn, vector_at(links, k, OFFSET)))
    axis = vector_at(links, k, AXIS)
    turn = product(product(turn, matrix_at(links, k, TURN)), rotation(axis, sine, cosine))
    z = turned(turn, axis)
    lever = cross(place, z)
    # S' = v x S: the motion of the links before carries the axis along
    a_w = plus(a_w, scaled(speed, cross(w, z)))
    a_v = plus(a_v, scaled(speed, plus(cross(w, lever), cross(v, z))))
    w = plus(w, scaled(speed, z))
    v = plus(v, scaled(speed, lever))
    inertia = matrix_at(links, k, INERTIA)
    body = _about_origin(links[k, MASS], vector_at(links, k, MOMENT), inertia, turn, place)
    if links[k, CARRIES] > 0.0:
        body = _with_point(body, hanging, plus(place, turned(turn, vector_at(links, k, TOOL))))
    turning, moving = _momentum(body, w, v)
    rising, pushing = _momentum(body, a_w, a_v)
    for r in range(9):
        s[k, _TURN + r] = turn[r]
    for r in range(10):
        s[k, _BODY + r] = body[r]
    put_at(s, k, _PLACE, place)
    put_at(s, k, _W, w)
    put_at(s, k, _V, v)
    put_at(s, k, _CHANGE_W, a_w)
    put_at(s, k, _CHANGE_V, a_v)
    put_at(s, k, _SCREW_W, z)
    put_at(s, k, _SCREW_V, lever)
    put_at(s, k, _TORQUE, plus(rising, plus(cross(w, turning), cross(v, moving))))
    put_at(s, k, _FORCE, plus(pushing, cross(w, moving)))


@njit
def _body_at(s: np.ndarray, k: int) -> Body:
    f = _BODY
    return (
        s[k, f], s[k, f + 1], s[k, f + 2], s[k, f + 3], s[k, f + 4],
        s[k, f + 5], s[k, f + 6], s[k, f + 7], s[k, f + 8], s[k, f + 9],
    )  # fmt: skip


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
    links: np.ndarray, q: np.ndarray, w: np.ndarray, a: np.ndarray, payload: np.ndarray | None = None
) -> np.ndarray:
    """Moments that a motion needs, M(q) q'' + c(q, q') [N m]. # (k, n).

    Args:
        links: what turns, rows of `link`. # (n, 36)
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
    links: np.ndarray,
    q: np.ndarray,
    w: np.ndarray,
    a: np.ndarray,
    payload: np.ndarray,
    s: np.ndarray,
    needed: np.ndarray,
) -> None:
    n = q.shape[1]
    matrix, bias = np.zeros((n, n)), np.empty(n)  # entries between two arms stay zero
    for k in range(len(q)):
        motion_equation(links, np.sin(q[k]), np.cos(q[k]), w[k], payload[k], s, matrix, bias)
        moments_of(links, matrix, a[k], needed[k])
        for i in range(n):
            needed[k, i] += bias[i]
