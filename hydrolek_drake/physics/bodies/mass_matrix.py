"""The mass matrix of links that turn on each other: factored, solved and multiplied along the tree of links.

Entries between links of which none carries the other are zero, and stay so in the factor (Featherstone, Rigid Body
Dynamics Algorithms, 2008, section 6.5).
"""

import math

import numpy as np

from hydrolek_drake.compiling import njit

PARENT = 0
"""Where a link's row, see `serial_arm.link`, has the place of the link that carries it."""

ROOT = -1
"""Parent of a link that turns on the base."""


@njit
def parent_of(links: np.ndarray, k: int) -> int:
    """Row of the link on which one turns, or `ROOT`."""
    return int(links[k, PARENT])


@njit
def factored(links: np.ndarray, matrix: np.ndarray) -> None:
    """M = L' L in place, of which only entries between a link and those that carry it are not zero.

    Those of L stand below the diagonal, and one over its own on it (Featherstone, table 6.3).

    Args:
        links: what turns, rows of `link`. # (n, 36)
        matrix: M; overwritten. # (n, n)
    """
    for k in range(len(links) - 1, -1, -1):
        matrix[k, k] = 1.0 / math.sqrt(matrix[k, k])
        i = parent_of(links, k)
        while i != ROOT:
            matrix[k, i] *= matrix[k, k]
            i = parent_of(links, i)
        i = parent_of(links, k)
        while i != ROOT:
            j = i
            while j != ROOT:
                matrix[i, j] -= matrix[k, i] * matrix[k, j]
                j = parent_of(links, j)
            i = parent_of(links, i)


@njit
def solved(links: np.ndarray, factor: np.ndarray, torque: np.ndarray) -> None:
    """Solve M q'' = tau in place (Featherstone, table 6.5).

    Args:
        links: what turns, rows of `link`. # (n, 36)
        factor: of M, see `factored`. # (n, n)
        torque: tau; receives q''. # (n,)
    """
    for i in range(len(links) - 1, -1, -1):
        torque[i] *= factor[i, i]
        j = parent_of(links, i)
        while j != ROOT:
            torque[j] -= factor[i, j] * torque[i]
            j = parent_of(links, j)
    for i in range(len(links)):
        j = parent_of(links, i)
        while j != ROOT:
            torque[i] -= factor[i, j] * torque[j]
            j = parent_of(links, j)
        torque[i] *= factor[i, i]


@njit
def accelerations(links: np.ndarray, matrix: np.ndarray, torque: np.ndarray) -> None:
    """Solve M q'' = tau in place.

    Args:
        links: what turns, rows of `link`. # (n, 36)
        matrix: M; overwritten. # (n, n)
        torque: tau; receives q''. # (n,)
    """
    factored(links, matrix)
    solved(links, matrix, torque)


@njit
def moments_of(links: np.ndarray, matrix: np.ndarray, acceleration: np.ndarray, moments: np.ndarray) -> None:
    """M q''.

    Args:
        links: what turns, rows of `link`. # (n, 36)
        matrix: M. # (n, n)
        acceleration: q''. # (n,)
        moments: receives them. # (n,)
    """
    for i in range(len(links)):
        moments[i] = matrix[i, i] * acceleration[i]
        j = parent_of(links, i)
        while j != ROOT:
            moments[i] += matrix[i, j] * acceleration[j]
            moments[j] += matrix[i, j] * acceleration[i]
            j = parent_of(links, j)
