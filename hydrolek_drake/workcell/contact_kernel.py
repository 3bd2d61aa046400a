"""Contact of fingers, rods with round ends, with a pipe, compiled: F = k d (1 + c d') (Hunt and Crossley 1975)."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True)
def touch(
    ends: Array,
    radii: Array,
    rotation: Array,
    origin: Array,
    turning: Array,
    sliding: Array,
    axis: Array,
    radius: float,
    half_length: float,
    stiffness: float,
    damping: float,
    points: Array,
    forces: Array,
) -> None:
    """Points and forces of one link's fingers.

    Args:
        ends: Of the fingers' middle lines in the link's frame, in m, shape (n, 2, 3).
        radii: Of the fingers in m, shape (n,).
        rotation: Of the link in the world, shape (3, 3).
        origin: Of the link from the middle of the pipe, world frame, in m, shape (3,).
        turning: Angular velocity of the link against the pipe, world frame, in rad/s, shape (3,).
        sliding: Velocity of the link's origin against the pipe, world frame, in m/s, shape (3,).
        axis: Of the pipe, world frame, a unit vector, shape (3,).
        radius: Of the pipe in m.
        half_length: Of the pipe in m.
        stiffness: k in N/m.
        damping: c in s/m.
        points: Receives where each finger is pushed, in the link's frame in m, shape (n, 3); what does not touch is
            left as it is.
        forces: Receives what it is pushed with, world frame, in N, shape (n, 3); likewise.
    """
    for i in range(len(radii)):
        first = rotation @ ends[i, 0]
        way = rotation @ ends[i, 1] - first
        from_pipe = origin + first
        square = from_pipe - np.dot(from_pipe, axis) * axis
        across = way - np.dot(way, axis) * axis
        length = np.dot(across, across)
        share = min(max(-np.dot(square, across) / length, 0.0), 1.0) if length > 0.0 else 0.0
        nearest = square + share * across
        distance = np.sqrt(np.dot(nearest, nearest))
        depth = radius + radii[i] - distance
        arm = first + share * way
        if depth <= 0.0 or distance == 0.0 or abs(np.dot(origin + arm, axis)) > half_length:
            continue
        normal = nearest / distance
        outwards = np.dot(normal, sliding + np.cross(turning, arm))
        forces[i] = stiffness * depth * max(0.0, 1.0 - damping * outwards) * normal
        points[i] = rotation.T @ arm
