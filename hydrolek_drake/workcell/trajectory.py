"""A path of postures as a function of time, within the speed that the valves give each joint."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydrake.trajectories import PiecewisePolynomial

from hydrolek_drake.errors import InputError
from hydrolek_drake.workcell.pipe import workcell_entries

Array = NDArray[np.float64]

_PEAK_SPEED = 1.5  # of the cubic 3 s^2 - 2 s^3 that starts and ends at rest, over its mean
_SAMPLED = 1.01  # a peak between two of the samples lies this little higher at most
_PEAK_ACCELERATION = 6.0  # of the same, over length / duration^2
_AT_REST = 0.05  # of a path on which nothing moves [s]: a period of the sequencer


def time_parametrised(path: ArrayLike) -> Any:
    """Trajectory through all postures of a path, at rest at each corner, within speed and acceleration.

    On a straight stretch of joint space all joints move together by the cubic 3 s^2 - 2 s^3, so that the path is
    exactly the one that was checked for collisions; the slowest joint sets the duration.

    Args:
        path: Postures of both arms in rad, shape (n, 14).

    Returns:
        A `pydrake.trajectories.PiecewisePolynomial` with 14 rows, from time 0.

    Raises:
        InputError: Fewer than one posture, or not 14 joints.
    """
    postures = np.asarray(path, dtype=float)
    if postures.ndim != 2 or postures.shape[0] < 1 or postures.shape[1] != 14:
        raise InputError(f"path has shape {postures.shape}; give postures of 14 joints, (n, 14)")
    speed, acceleration = joint_speeds()
    times, kept = [0.0], [postures[0]]
    for posture in postures[1:]:
        length = np.abs(posture - kept[-1])
        if length.max() < 1e-9:
            continue
        duration = max(
            float(np.max(_PEAK_SPEED * length / speed)),
            float(np.sqrt(np.max(_PEAK_ACCELERATION * length / acceleration))),
        )
        times.append(times[-1] + duration)
        kept.append(posture)
    if len(kept) == 1:  # a constant of Drake's has no end, for which a step would wait
        times, kept = [0.0, _AT_REST], [kept[0], kept[0]]
    knots = np.array(kept).T
    return PiecewisePolynomial.CubicHermite(times, knots, np.zeros_like(knots))


def smooth_trajectory(path: ArrayLike) -> Any:
    """Trajectory through all postures of a path without stopping between them, within speed and acceleration.

    A spline with continuous acceleration, at rest at both ends, stretched in time until no joint exceeds either limit.
    Between the postures it bends away from the straight stretches: for postures that lie close together, as along a
    straight path of the tool.

    Args:
        path: Postures of both arms in rad, shape (n, 14).

    Returns:
        A `pydrake.trajectories.PiecewisePolynomial` with 14 rows, from time 0.

    Raises:
        InputError: Not 14 joints.
    """
    postures = np.asarray(path, dtype=float)
    if len(postures) < 3:
        return time_parametrised(postures)
    if postures.ndim != 2 or postures.shape[1] != 14:
        raise InputError(f"path has shape {postures.shape}; give postures of 14 joints, (n, 14)")
    speed, acceleration = joint_speeds()
    steps = np.max(np.abs(np.diff(postures, axis=0)) / speed, axis=1)
    share = np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-3))])
    # the times at which 3 s^2 - 2 s^3 has gone this share of the way: slow at both ends
    breaks = 0.5 - np.sin(np.arcsin(1.0 - 2.0 * share / share[-1]) / 3.0)
    rest = np.zeros(14)
    spline = PiecewisePolynomial.CubicWithContinuousSecondDerivatives(breaks, postures.T, rest, rest)
    first, second = spline.derivative(1), spline.derivative(2)
    times = np.unique(np.concatenate([breaks, np.linspace(0.0, breaks[-1], 400)]))
    fastest = max(float(np.max(np.abs(first.value(t)[:, 0]) / speed)) for t in times)
    hardest = max(float(np.max(np.abs(second.value(t)[:, 0]) / acceleration)) for t in times)
    stretch = max(fastest, float(np.sqrt(hardest))) * _SAMPLED
    return PiecewisePolynomial.CubicWithContinuousSecondDerivatives(breaks * stretch, postures.T, rest, rest)


def joint_speeds() -> tuple[Array, Array]:
    """Largest speed in rad/s and acceleration in rad/s^2 of both arms' joints, each of shape (14,)."""
    values = workcell_entries()["motion"]
    return (
        np.radians(np.tile(values["joint_speed_deg_per_s"], 2)),
        np.radians(np.tile(values["joint_acceleration_deg_per_s2"], 2)),
    )
