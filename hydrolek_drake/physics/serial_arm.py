"""Equation of motion of turning links, one on another: M(q) q'' + c(q, q') = tau, with gravity in c.

The Diagram's arms are a MultibodyPlant; the compiled rollout of joints that move together has these recursions, and
tests hold one against the other. Newton-Euler for c and composite bodies for M (Featherstone, Rigid Body Dynamics
Algorithms, 2008, sections 5.3 and 6.2), in the axes of the base. A link's mass, first moment m r and inertia about its
own joint add up, so that a payload is three more terms.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

Vector = tuple[float, float, float]

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
    """Room for `motion_equation`."""

    turned: np.ndarray  # axes of each link in those of the base. # (n, 3, 3)
    out: np.ndarray  # from the parent's joint. # (n, 3)
    axis: np.ndarray  # (n, 3)
    rate: np.ndarray  # angular velocity. # (n, 3)
    angular: np.ndarray  # angular acceleration without q''. # (n, 3)
    linear: np.ndarray  # acceleration of the joint without q'', less gravity. # (n, 3)
    force: np.ndarray  # (n, 3)
    torque: np.ndarray  # about the joint. # (n, 3)
    mass: np.ndarray  # of a link and all that it carries. # (n,)
    moment: np.ndarray  # of the same. # (n, 3)
    inertia: np.ndarray  # of the same. # (n, 3, 3)


def scratch(count: int) -> Scratch:
    """Room for so many links."""
    matrices, vectors = np.zeros((2, count, 3, 3)), np.zeros((8, count, 3))
    return Scratch(*[matrices[0], *vectors[:7], np.zeros(count), vectors[7], matrices[1]])


@njit
def _of(rows: np.ndarray, i: int) -> Vector:
    return rows[i, 0], rows[i, 1], rows[i, 2]


@njit
def _put(rows: np.ndarray, i: int, v: Vector) -> None:
    rows[i, 0], rows[i, 1], rows[i, 2] = v


@njit
def _plus(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@njit
def _scaled(f: float, a: Vector) -> Vector:
    return f * a[0], f * a[1], f * a[2]


@njit
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@njit
def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@njit
def _times(matrices: np.ndarray, i: int, v: Vector) -> Vector:
    m = matrices
    return (
        m[i, 0, 0] * v[0] + m[i, 0, 1] * v[1] + m[i, 0, 2] * v[2],
        m[i, 1, 0] * v[0] + m[i, 1, 1] * v[1] + m[i, 1, 2] * v[2],
        m[i, 2, 0] * v[0] + m[i, 2, 1] * v[1] + m[i, 2, 2] * v[2],
    )


@njit
def _put_column(matrices: np.ndarray, i: int, column: int, v: Vector) -> None:
    matrices[i, 0, column], matrices[i, 1, column], matrices[i, 2, column] = v


@njit
def _turn(links: Links, i: int, angle: float, base: bool, turned: np.ndarray) -> None:
    """Axes of a link: those of its parent, turned to its joint and about its axis (Rodrigues' formula)."""
    x, y, z = links.axis[i, 0], links.axis[i, 1], links.axis[i, 2]
    s, c = np.sin(angle), np.cos(angle)
    v = 1.0 - c
    about = (
        (c + v * x * x, v * x * y - s * z, v * x * z + s * y),
        (v * x * y + s * z, c + v * y * y, v * y * z - s * x),
        (v * x * z - s * y, v * y * z + s * x, c + v * z * z),
    )
    fixed = links.turn
    for row in range(3):
        r0, r1, r2 = fixed[i, row, 0], fixed[i, row, 1], fixed[i, row, 2]
        for column in range(3):
            turned[i, row, column] = r0 * about[0][column] + r1 * about[1][column] + r2 * about[2][column]
    if base:
        return
    p = links.parent[i]
    for column in range(3):
        own = turned[i, 0, column], turned[i, 1, column], turned[i, 2, column]
        _put_column(turned, i, column, _times(turned, p, own))


@njit
def _bodies(links: Links, i: int, payload: float, s: Scratch) -> None:
    """Mass, first moment and inertia of a link with its payload, in the base's axes."""
    r, own = s.turned, links.inertia
    s.mass[i] = links.mass[i]
    _put(s.moment, i, _times(s.turned, i, _of(links.moment, i)))
    for b in range(3):  # R I R', column by column
        column = _times(r, i, _times(own, i, (r[i, b, 0], r[i, b, 1], r[i, b, 2])))
        _put_column(s.inertia, i, b, column)
    hangs = payload * links.carries[i]
    if hangs > 0.0:
        at = _times(s.turned, i, _of(links.tool, i))
        s.mass[i] += hangs
        _put(s.moment, i, _plus(_of(s.moment, i), _scaled(hangs, at)))
        _add_about(s.inertia, i, hangs, at, (0.0, 0.0, 0.0))


@njit
def _add_about(inertia: np.ndarray, i: int, mass: float, out: Vector, moment: Vector) -> None:
    """Add what a body adds to the inertia about a point from which its own point is `out`, beyond its own inertia.

    m (|d|^2 1 - d d') + 2 (d.h) 1 - d h' - h d', with d `out` and h its first moment about its own point.
    """
    along = mass * _dot(out, out) + 2.0 * _dot(out, moment)
    for a in range(3):
        inertia[i, a, a] += along
        for b in range(3):
            inertia[i, a, b] -= mass * out[a] * out[b] + out[a] * moment[b] + moment[a] * out[b]


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
        matrix: receives M [kg m^2]. # (n, n)
        bias: receives c [N m]. # (n,)
    """
    n = len(q)
    up = (-links.gravity[0], -links.gravity[1], -links.gravity[2])
    for i in range(n):
        p = links.parent[i]
        base = p == ROOT
        out = _of(links.offset, i)
        rate = angular = (0.0, 0.0, 0.0)
        linear = up
        if not base:
            out = _times(s.turned, p, out)
            rate, angular = _of(s.rate, p), _of(s.angular, p)
            spun = _cross(rate, _cross(rate, out))
            linear = _plus(_of(s.linear, p), _plus(_cross(angular, out), spun))
        _turn(links, i, q[i], base, s.turned)
        axis = _times(s.turned, i, _of(links.axis, i))
        turning = _scaled(w[i], axis)
        angular = _plus(angular, _cross(rate, turning))
        rate = _plus(rate, turning)
        _bodies(links, i, payload[i], s)
        moment = _of(s.moment, i)
        spun = _cross(rate, _cross(rate, moment))
        spin = _times(s.inertia, i, rate)
        _put(s.out, i, out)
        _put(s.axis, i, axis)
        _put(s.rate, i, rate)
        _put(s.angular, i, angular)
        _put(s.linear, i, linear)
        _put(s.force, i, _plus(_scaled(s.mass[i], linear), _plus(_cross(angular, moment), spun)))
        turned_up = _plus(_times(s.inertia, i, angular), _cross(rate, spin))
        _put(s.torque, i, _plus(turned_up, _cross(moment, linear)))
    for j in range(n - 1, -1, -1):
        axis, p = _of(s.axis, j), links.parent[j]
        bias[j] = _dot(axis, _of(s.torque, j))
        force, torque = _cross(axis, _of(s.moment, j)), _times(s.inertia, j, axis)
        i = j
        while True:
            matrix[i, j] = matrix[j, i] = _dot(_of(s.axis, i), torque)
            if links.parent[i] == ROOT:
                break
            torque = _plus(torque, _cross(_of(s.out, i), force))
            i = links.parent[i]
        if p == ROOT:
            continue
        out = _of(s.out, j)
        _put(s.force, p, _plus(_of(s.force, p), _of(s.force, j)))
        carried = _plus(_of(s.torque, j), _cross(out, _of(s.force, j)))
        _put(s.torque, p, _plus(_of(s.torque, p), carried))
        for a in range(3):
            for b in range(3):
                s.inertia[p, a, b] += s.inertia[j, a, b]
        _add_about(s.inertia, p, s.mass[j], out, _of(s.moment, j))
        _put(s.moment, p, _plus(_of(s.moment, p), _plus(_of(s.moment, j), _scaled(s.mass[j], out))))
        s.mass[p] += s.mass[j]


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
