"""From the object and two clicks to grasp, approach and cut in the camera frame: thesis sections 5.2.5, 5.2.6."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import CameraModel
from hydrolek_drake.vision.centre_line import CentreLine, centre_line
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.cylinder import Cylinder, fit_cylinder
from hydrolek_drake.vision.selection import Snapshot

Array = NDArray[np.float64]

_SEED = 2  # of the points that the cylinder is fitted to: the same clicks give the same targets
_RIM = 3  # px: depth beside an object's outline mixes with what is behind it
_ALMOST_ALONG = 0.05  # sine of the angle between sight and pipe below which the pipe has no side to grasp


@dataclass(frozen=True)
class PixelTargets:
    """The four goals of section 5.2.5 in px, and the depth of the two clicked ones in m.

    Attributes:
        line: The object's centre line.
        grasp: Snapped to the line, shape (2,).
        cut: Snapped to the line, shape (2,).
        cut_ends: Start and end of the cut, shape (2, 2).
        grasp_depth: Depth of the surface at the grasp.
        cut_depth: Depth of the surface at the cut.
    """

    line: CentreLine
    grasp: Array
    cut: Array
    cut_ends: Array
    grasp_depth: float
    cut_depth: float


@dataclass(frozen=True)
class PipeTargets:
    """Goals in the camera frame, in m, on the axis of the fitted cylinder.

    Attributes:
        cylinder: Axis and radius of the pipe.
        grasp: Point of the axis to grasp, shape (3,).
        cut: Point of the axis to cut, shape (3,).
        approach_direction: Unit vector from the camera's side square onto the pipe, shape (3,).
        approach: In front of the grasp, shape (3,).
        cut_start: Beside the pipe, at the depth of its axis, shape (3,).
        cut_end: On its other side.
    """

    cylinder: Cylinder
    grasp: Array
    cut: Array
    approach_direction: Array
    approach: Array
    cut_start: Array
    cut_end: Array


def pixel_targets(
    snapshot: Snapshot,
    selected: NDArray[np.bool_],
    grasp_click: ArrayLike,
    cut_click: ArrayLike,
    camera: CameraModel,
) -> PixelTargets:
    """Snap both clicks to the centre line and lay the cut across it.

    Raises:
        InputError: A click outside the picture, or no depth near one.
    """
    line = centre_line(selected)
    clicks = {"grasp": np.asarray(grasp_click, dtype=float), "cut": np.asarray(cut_click, dtype=float)}
    points, depths = {}, {}
    for name, click in clicks.items():
        if click.shape != (2,) or not np.isfinite(click).all() or not camera.holds(click):
            raise InputError(
                f"the {name} click at {click.tolist()} is outside the picture of "
                f"{camera.width} x {camera.height}; click on the object"
            )
        points[name] = line.snap(click)
        depths[name] = depth_at(snapshot.surfaces.depth, selected, points[name], name)
    clearance = kinect_entries("targets")["clearance"] * camera.focal_x / depths["cut"]
    return PixelTargets(
        line,
        points["grasp"],
        points["cut"],
        line.cut(points["cut"], clearance),
        depths["grasp"],
        depths["cut"],
    )


def depth_at(
    depth: NDArray[np.float32], selected: NDArray[np.bool_], pixel: Array, name: str = "clicked"
) -> float:
    """Depth of the object at a pixel, in m: the median of its readings nearest to it.

    Raises:
        InputError: The object has no depth reading at all.
    """
    rows, columns = np.nonzero(selected & (depth > 0))
    if not len(rows):
        raise InputError(
            f"the {name} point has no depth: the object is all holes; move the camera or the light"
        )
    far = (rows - pixel[1]) ** 2 + (columns - pixel[0]) ** 2
    nearest = np.argsort(far)[:25]
    return float(np.median(depth[rows[nearest], columns[nearest]]))


def pipe_targets(
    snapshot: Snapshot, selected: NDArray[np.bool_], pixels: PixelTargets, camera: CameraModel
) -> PipeTargets:
    """Fit a cylinder to the object's depth and place the goals on its axis.

    The approach is along the line of sight, turned square to the pipe; the cut is square to the pipe and to the
    approach.

    Raises:
        InputError: The object is no cylinder, or is seen along its axis.
    """
    values = kinect_entries("targets")
    size = 2 * _RIM + 1
    inner = cv2.erode(selected.astype(np.uint8), np.ones((size, size), np.uint8)).astype(bool)
    depth = snapshot.surfaces.depth
    inside = inner & (depth > 0)
    if inside.sum() < 50:
        inside = selected & (depth > 0)
    rows, columns = np.nonzero(inside)
    points = camera.point(np.column_stack([columns, rows]), depth[rows, columns])
    cylinder = fit_cylinder(points, np.random.default_rng(_SEED))
    grasp = cylinder.where_seen(camera.point(pixels.grasp, 1.0))
    cut = cylinder.where_seen(camera.point(pixels.cut, 1.0))
    sight = grasp / np.linalg.norm(grasp)
    direction = sight - (sight @ cylinder.axis) * cylinder.axis
    if np.linalg.norm(direction) < _ALMOST_ALONG:
        raise InputError("the pipe is seen end on; move the machine so that its side is in view")
    direction /= np.linalg.norm(direction)
    across = np.cross(cylinder.axis, direction)
    reach = cylinder.radius + values["clearance"]
    return PipeTargets(
        cylinder,
        grasp,
        cut,
        direction,
        grasp - (cylinder.radius + values["approach"]) * direction,
        cut - reach * across,
        cut + reach * across,
    )
