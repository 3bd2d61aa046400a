"""Vectors and matrices of space as tuples, for compiled code: in registers, without arrays."""

import numpy as np

from hydrolek_drake.compiling import njit

Vector = tuple[float, float, float]
Matrix = tuple[float, float, float, float, float, float, float, float, float]
"""Row by row."""


@njit
def rotation(axis: Vector, sine: float, cosine: float) -> Matrix:
    """Rotation about a unit vector (Rodrigues), by an angle of which sine and cosine are known."""
    x, y, z = axis
    s, c = sine, cosine
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


@njit
def product(p: Matrix, q: Matrix) -> Matrix:
    """Matrix product."""
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


@njit
def matrix_at(rows: np.ndarray, k: int, first: int) -> Matrix:
    """Nine numbers of a row, from one of its places on."""
    f = first
    return (
        rows[k, f],
        rows[k, f + 1],
        rows[k, f + 2],
        rows[k, f + 3],
        rows[k, f + 4],
        rows[k, f + 5],
        rows[k, f + 6],
        rows[k, f + 7],
        rows[k, f + 8],
    )


@njit
def turned(turn: Matrix, p: Vector) -> Vector:
    """Matrix times vector."""
    return (
        turn[0] * p[0] + turn[1] * p[1] + turn[2] * p[2],
        turn[3] * p[0] + turn[4] * p[1] + turn[5] * p[2],
        turn[6] * p[0] + turn[7] * p[1] + turn[8] * p[2],
    )


@njit
def cross(p: Vector, q: Vector) -> Vector:
    """Cross product."""
    return p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]


@njit
def dot(p: Vector, q: Vector) -> float:
    """Scalar product."""
    return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]


@njit
def plus(p: Vector, q: Vector) -> Vector:
    """Sum."""
    return p[0] + q[0], p[1] + q[1], p[2] + q[2]


@njit
def scaled(factor: float, p: Vector) -> Vector:
    """A vector times a number."""
    return factor * p[0], factor * p[1], factor * p[2]


@njit
def vector_at(rows: np.ndarray, k: int, first: int) -> Vector:
    """Three numbers of a row, from one of its places on."""
    return rows[k, first], rows[k, first + 1], rows[k, first + 2]


@njit
def put_at(rows: np.ndarray, k: int, first: int, v: Vector) -> None:
    """Write a vector into a row, from one of its places on."""
    rows[k, first], rows[k, first + 1], rows[k, first + 2] = v
