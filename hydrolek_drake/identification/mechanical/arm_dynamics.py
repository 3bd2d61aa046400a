"""A chain of rigid links on revolute joints, compiled: the arm's dynamics for thousands of simulations.

Everything is expressed in world axes about the world's origin, where spatial quantities of several bodies
are simply added (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapters 2, 5 and 6). A test holds mass
matrix and bias against Drake's MultibodyPlant of the same arm.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from hydrolek_drake.compiled import use_cache_for_this_source

use_cache_for_this_source()


@njit(cache=True)
def mass_matrix_and_bias(
    angles: np.ndarray,
    rates: np.ndarray,
    offsets: np.ndarray,
    axes: np.ndarray,
    masses: np.ndarray,
    moments: np.ndarray,
    inertias: np.ndarray,
    gravity: float,
    matrix: np.ndarray,
    bias: np.ndarray,
) -> None:
    """Mass matrix M and bias c (Coriolis, centrifugal and gravity) of M q'' + c = torque, equation (4.1).

    Args:
        angles: q [rad]. # (n,)
        rates: q' [rad/s]. # (n,)
        offsets: each joint's place in the link before it [m]. # (n, 3)
        axes: each joint's axis in its own link, unit vectors. # (n, 3)
        masses: of the links [kg]. # (n,)
        moments: mass times centre of mass, in the link's axes [kg m]. # (n, 3)
        inertias: about the joint's place, in the link's axes [kg m^2]. # (n, 3, 3)
        gravity: along -Y of the first link's parent [m/s^2].
        matrix: filled with M. # (n, n)
        bias: filled with c. # (n,)
    """
    n = len(angles)
    turn = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
    place = (0.0, 0.0, 0.0)
    w, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    a_w, a_v = (0.0, 0.0, 0.0), (0.0, gravity, 0.0)  # gravity is a base that accelerates upwards
    screws = np.empty((n, 6))
    bodies = np.empty((n, 10))  # mass, moment, inertia xx xy xz yy yz zz about the origin
    wrenches = np.empty((n, 6))  # torque, force
    for k in range(n):
        place = _sum(place, _turned(turn, (offsets[k, 0], offsets[k, 1], offsets[k, 2])))
        axis = (axes[k, 0], axes[k, 1], axes[k, 2])
        turn = _times(turn, _about(axis, angles[k]))
        z = _turned(turn, axis)
        lever = _cross(place, z)
        rate = rates[k]
        # S' = v x S: the motion of the links before carries the axis along
        a_w = _sum(a_w, _scaled(rate, _cross(w, z)))
        a_v = _sum(a_v, _scaled(rate, _sum(_cross(w, lever), _cross(v, z))))
        w = _sum(w, _scaled(rate, z))
        v = _sum(v, _scaled(rate, lever))
        body = _body_about_origin(masses[k], moments[k], inertias[k], turn, place)
        turning, moving = _momentum(body, w, v)
        rising, pushing = _momentum(body, a_w, a_v)
        torque = _sum(rising, _sum(_cross(w, turning), _cross(v, moving)))
        force = _sum(pushing, _cross(w, moving))
        for r in range(3):
            screws[k, r], screws[k, 3 + r] = z[r], lever[r]
            wrenches[k, r], wrenches[k, 3 + r] = torque[r], force[r]
        for r in range(10):
            bodies[k, r] = body[r]
    for k in range(n - 2, -1, -1):
        for r in range(10):
            bodies[k, r] += bodies[k + 1, r]
        for r in range(6):
            wrenches[k, r] += wrenches[k + 1, r]
    for k in range(n):
        bias[k] = 0.0
        for r in range(6):
            bias[k] += screws[k, r] * wrenches[k, r]
        b = bodies[k]
        whole = (b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8], b[9])
        turning, moving = _momentum(
            whole, (screws[k, 0], screws[k, 1], screws[k, 2]), (screws[k, 3], screws[k, 4], screws[k, 5])
        )
        for j in range(k + 1):
            entry = 0.0
            for r in range(3):
                entry += screws[j, r] * turning[r] + screws[j, 3 + r] * moving[r]
            matrix[j, k] = entry
            matrix[k, j] = entry


@njit(cache=True)
def simulate_joints(
    command: np.ndarray,
    step: float,
    gain: float,
    damping: float,
    stiffness: float,
    offsets: np.ndarray,
    axes: np.ndarray,
    masses: np.ndarray,
    moments: np.ndarray,
    inertias: np.ndarray,
    gravity: float,
) -> np.ndarray:
    """Angles of all joints, M q'' + c + D q' + S q = K u, from rest at zero.

    The linearly implicit Euler method: damping and stiffness at the end of the step, M and c at its start,
    so that links whose inertia is small beside D h are stable.

    Args:
        command: u of each joint, held over a step. # (steps, n)
        step: h [s].
        gain: K [N m per unit of u].
        damping: D of each joint [N m s/rad].
        stiffness: S of each joint [N m/rad].
        offsets: as in `mass_matrix_and_bias`, and so the rest.
        axes: unit vectors.
        masses: [kg].
        moments: [kg m].
        inertias: [kg m^2].
        gravity: [m/s^2].

    Returns:
        Angle before each step [rad]; NaN after a divergence. # (steps, n)
    """
    steps, n = command.shape
    angles = np.zeros(n)
    rates = np.zeros(n)
    matrix = np.empty((n, n))
    bias = np.empty(n)
    out = np.full((steps, n), np.nan)
    added = step * damping + step * step * stiffness
    for k in range(steps):
        for i in range(n):
            if not abs(angles[i]) < 1e6:  # a turn count that no arm reaches
                return out
            out[k, i] = angles[i]
        mass_matrix_and_bias(angles, rates, offsets, axes, masses, moments, inertias, gravity, matrix, bias)
        for i in range(n):
            push = gain * command[k, i] - bias[i] - damping * rates[i]
            bias[i] = step * (push - stiffness * (angles[i] + step * rates[i]))
            matrix[i, i] += added
        _solve_in_place(matrix, bias)
        for i in range(n):
            rates[i] += bias[i]
            angles[i] += step * rates[i]
    return out


@njit(cache=True)
def _solve_in_place(matrix: np.ndarray, right: np.ndarray) -> None:
    """Cholesky solution of a symmetric positive definite system; overwrites both."""
    n = len(right)
    for j in range(n):
        for k in range(j):
            matrix[j, j] -= matrix[j, k] * matrix[j, k]
        matrix[j, j] = np.sqrt(matrix[j, j])
        for i in range(j + 1, n):
            for k in range(j):
                matrix[i, j] -= matrix[i, k] * matrix[j, k]
            matrix[i, j] /= matrix[j, j]
    for i in range(n):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(n - 1, -1, -1):
        for k in range(i + 1, n):
            right[i] -= matrix[k, i] * right[k]
        right[i] /= matrix[i, i]


@njit(cache=True)
def _body_about_origin(mass: float, moment: Any, inertia: Any, turn: Any, place: Any) -> Any:
    """Mass, moment and inertia of a link in world axes about the world's origin, ten numbers."""
    h = _turned(turn, (moment[0], moment[1], moment[2]))
    half = _times(
        turn,
        (
            inertia[0, 0],
            inertia[0, 1],
            inertia[0, 2],
            inertia[1, 0],
            inertia[1, 1],
            inertia[1, 2],
            inertia[2, 0],
            inertia[2, 1],
            inertia[2, 2],
        ),
    )
    x, y, z = place
    a, b, c = h
    # shift from the joint's place p: m (p.p 1 - p p') + 2 (h.p) 1 - h p' - p h'
    d = mass * (x * x + y * y + z * z) + 2.0 * (a * x + b * y + c * z)
    xx = half[0] * turn[0] + half[1] * turn[1] + half[2] * turn[2] + d - mass * x * x - 2.0 * a * x
    yy = half[3] * turn[3] + half[4] * turn[4] + half[5] * turn[5] + d - mass * y * y - 2.0 * b * y
    zz = half[6] * turn[6] + half[7] * turn[7] + half[8] * turn[8] + d - mass * z * z - 2.0 * c * z
    xy = half[0] * turn[3] + half[1] * turn[4] + half[2] * turn[5] - mass * x * y - a * y - b * x
    xz = half[0] * turn[6] + half[1] * turn[7] + half[2] * turn[8] - mass * x * z - a * z - c * x
    yz = half[3] * turn[6] + half[4] * turn[7] + half[5] * turn[8] - mass * y * z - b * z - c * y
    return mass, a + mass * x, b + mass * y, c + mass * z, xx, xy, xz, yy, yz, zz


@njit(cache=True)
def _momentum(body: Any, w: Any, v: Any) -> Any:
    """Angular and linear momentum of a body about the origin."""
    m, a, b, c, xx, xy, xz, yy, yz, zz = body
    h = (a, b, c)
    spin = (
        xx * w[0] + xy * w[1] + xz * w[2],
        xy * w[0] + yy * w[1] + yz * w[2],
        xz * w[0] + yz * w[1] + zz * w[2],
    )
    return _sum(spin, _cross(h, v)), _sum(_scaled(m, v), _cross(w, h))


@njit(cache=True)
def _about(axis: Any, angle: float) -> Any:
    """Rotation about a unit vector (Rodrigues), row by row."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis
    d = 1.0 - c
    return (
        c + d * x * x,
        d * x * y - s * z,
        d * x * z + s * y,
        d * x * y + s * z,
        c + d * y * y,
        d * y * z - s * x,
        d * x * z - s * y,
        d * y * z + s * x,
        c + d * z * z,
    )


@njit(cache=True)
def _times(p: Any, q: Any) -> Any:
    return (
        p[0] * q[0] + p[1] * q[3] + p[2] * q[6],
        p[0] * q[1] + p[1] * q[4] + p[2] * q[7],
        p[0] * q[2] + p[1] * q[5] + p[2] * q[8],
        p[3] * q[0] + p[4] * q[3] + p[5] * q[6],
        p[3] * q[1] + p[4] * q[4] + p[5] * q[7],
        p[3] * q[2] + p[4] * q[5] + p[5] * q[8],
        p[6] * q[0] + p[7] * q[3] + p[8] * q[6],
        p[6] * q[1] + p[7] * q[4] + p[8] * q[7],
        p[6] * q[2] + p[7] * q[5] + p[8] * q[8],
    )


@njit(cache=True)
def _turned(turn: Any, p: Any) -> Any:
    return (
        turn[0] * p[0] + turn[1] * p[1] + turn[2] * p[2],
        turn[3] * p[0] + turn[4] * p[1] + turn[5] * p[2],
        turn[6] * p[0] + turn[7] * p[1] + turn[8] * p[2],
    )


@njit(cache=True)
def _cross(p: Any, q: Any) -> Any:
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


@njit(cache=True)
def _sum(p: Any, q: Any) -> Any:
    return p[0] + q[0], p[1] + q[1], p[2] + q[2]


@njit(cache=True)
def _scaled(factor: float, p: Any) -> Any:
    return factor * p[0], factor * p[1], factor * p[2]
