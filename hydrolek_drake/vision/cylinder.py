"""Axis and radius of a pipe from the depth points on it, so that a tilted pipe is grasped square."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.configuration import kinect_entries

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cylinder:
    """A cylinder fitted to points.

    Attributes:
        point: Point on the axis amid the fitted points, in m, shape (3,).
        axis: Unit vector along it, shape (3,).
        radius: In m.
        residual: Root mean square distance of the points from the surface, in m, outliers left out.
        half_length: How far along the axis the points extend to either side of `point`, in m.
    """

    point: Array
    axis: Array
    radius: float
    residual: float
    half_length: float

    def nearest(self, point: ArrayLike) -> Array:
        """The point of the axis nearest to `point`, shape (3,)."""
        offset = np.asarray(point, dtype=float) - self.point
        return self.point + (offset @ self.axis) * self.axis

    def where_seen(self, ray: ArrayLike) -> Array:
        """The point of the axis nearest to a ray from the camera, shape (3,).

        Args:
            ray: Direction in the camera frame, shape (3,); must not be parallel to the axis.
        """
        ray = np.asarray(ray, dtype=float)
        # |s ray - point - t axis| is least for the s, t of these two equations
        matrix = np.array([[ray @ ray, -(ray @ self.axis)], [ray @ self.axis, -1.0]])
        _, along = np.linalg.solve(matrix, [ray @ self.point, self.axis @ self.point])
        return self.point + along * self.axis


def fit_cylinder(points: ArrayLike, generator: np.random.Generator) -> Cylinder:
    """Least squares with a robust loss over the axis (4 numbers) and the radius.

    Several starts: axes along the principal directions of the points and between them, each with the surface's
    middle a radius in front of the axis. The best fit counts.

    Args:
        points: On the visible side, in the camera frame (camera at the origin), in m, shape (n, 3).
        generator: To thin the points with.

    Raises:
        InputError: Too few points, or they do not lie on a cylinder.
    """
    values = kinect_entries("cylinder")
    cloud = np.asarray(points, dtype=float)
    if len(cloud) < 50:
        raise InputError(f"only {len(cloud)} depth points on the object; a cylinder needs 50 or more")
    if len(cloud) > values["points"]:
        cloud = cloud[generator.choice(len(cloud), int(values["points"]), replace=False)]
    middle = np.median(cloud, axis=0)
    _, spreads, directions = np.linalg.svd(cloud - middle, full_matrices=False)
    spreads = spreads / np.sqrt(len(cloud))
    sight = middle / np.linalg.norm(middle)
    best: tuple[float, Array, Array] | None = None
    for turn in (0.0, 0.5, 0.25, 0.75):
        axis = np.cos(np.pi * turn) * directions[0] + np.sin(np.pi * turn) * directions[1]
        radius = max(0.01, 1.5 * float(spreads[1]))
        frame = _frame(axis, sight)
        fit = least_squares(
            _misses,
            np.array([0.0, 0.0, 0.0, radius, radius]),
            args=(cloud - middle, frame),
            loss="soft_l1",
            f_scale=values["loss_scale"],
            bounds=(
                [-1.0, -1.0, -0.5, 1e-3, 1e-3],
                [1.0, 1.0, 0.5, 2 * values["largest_radius"], values["largest_radius"]],
            ),
            max_nfev=60,
        )
        if best is None or fit.cost < best[0]:
            best = (float(fit.cost), fit.x, frame)
    assert best is not None
    return _cylinder(best[1], best[2], cloud, middle, values["residual"])


def _frame(axis: Array, sight: Array) -> Array:
    """Rows: axis, across it and the line of sight, and away from the camera."""
    across = np.cross(axis, sight)
    if np.linalg.norm(across) < 1e-6:
        across = np.cross(axis, sight + np.array([0.1, 0.2, 0.0]))
    across /= np.linalg.norm(across)
    return np.stack([axis, across, np.cross(across, axis) * np.sign(np.cross(across, axis) @ sight or 1.0)])


def _line(parameters: Array, frame: Array) -> tuple[Array, Array]:
    tilt_across, tilt_away, across, away = parameters[:4]
    axis = frame[0] + tilt_across * frame[1] + tilt_away * frame[2]
    return across * frame[1] + away * frame[2], axis / np.linalg.norm(axis)


def _misses(parameters: Array, cloud: Array, frame: Array) -> Array:
    origin, axis = _line(parameters, frame)
    offset = cloud - origin
    return np.linalg.norm(offset - np.outer(offset @ axis, axis), axis=1) - parameters[4]


def _cylinder(parameters: Array, frame: Array, cloud: Array, middle: Array, largest: float) -> Cylinder:
    origin, axis = _line(parameters, frame)
    misses = np.abs(_misses(parameters, cloud - middle, frame))
    kept = misses <= np.percentile(misses, 90)
    residual = float(np.sqrt(np.mean(misses[kept] ** 2)))
    if residual > largest:
        raise InputError(
            f"the object is no pipe: its depth points miss the nearest cylinder by {1e3 * residual:.1f} mm "
            f"(at most {1e3 * largest:.1f} mm)"
        )
    along = (cloud - middle - origin)[kept] @ axis
    low, high = np.percentile(along, [1, 99])
    if axis[np.abs(axis).argmax()] < 0:
        axis, low, high = -axis, -high, -low
    point = middle + origin + (low + high) / 2 * axis
    return Cylinder(point, axis, float(parameters[4]), residual, float(high - low) / 2)
