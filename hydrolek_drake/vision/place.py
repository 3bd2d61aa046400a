"""Where a click puts an object down: a level piece of surface in the picture."""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import CameraModel, direction_to_frame
from hydrolek_drake.vision.selection import Snapshot

Array = NDArray[np.float64]

_FEWEST = 30  # readings that a plane is fitted to


def level_place(
    snapshot: Snapshot,
    selected: NDArray[np.bool_],
    click: ArrayLike,
    camera: CameraModel,
    *,
    around: int,
    steepest: float,
) -> Array:
    """The point of a level surface under a click, in the camera frame in m, shape (3,).

    A plane is fitted to the depth readings around the click, by least squares over inverse depth, in which a plane is
    linear in the pixels and the sensor's noise is even.

    Args:
        snapshot: The frame.
        selected: The object that is to be put there.
        click: u to the right and v down, in px.
        camera: That took the frame.
        around: Half width of the piece of picture that is looked at, in px.
        steepest: Largest inclination of a surface that counts as level, in rad.

    Raises:
        InputError: The click is outside the picture, on the object itself, on nothing within reach, on no surface or
            on one that is not level.
    """
    at = np.asarray(click, dtype=float)
    if at.shape != (2,) or not np.isfinite(at).all() or not camera.holds(at):
        raise InputError(
            f"the place click at {at.tolist()} is outside the picture of {camera.width} x {camera.height}; "
            "click on the table"
        )
    u, v = (round(value) for value in at)
    if selected[v, u]:
        raise InputError("the place is on the pipe itself; click on the table beside it")
    rows, columns = (slice(max(0, middle - around), middle + around + 1) for middle in (v, u))
    depth = snapshot.surfaces.depth[rows, columns]
    usable = (depth > 0) & ~selected[rows, columns]
    if np.count_nonzero(usable) < _FEWEST:
        raise InputError(f"nothing within reach at ({u}, {v}); click on the table where the camera sees it")
    found = np.argwhere(usable)
    offset = found - [v - rows.start, u - columns.start]
    terms = np.column_stack([offset, np.ones(len(offset))])
    fitted, *_ = np.linalg.lstsq(terms, 1.0 / depth[usable], rcond=None)
    if fitted[2] <= 0.0:
        raise InputError(f"there is no surface at ({u}, {v}); click on the table")
    corners = np.array([[0, 0], [0, around], [around, 0]])
    inverse = np.maximum(corners @ fitted[:2] + fitted[2], 1e-3)
    first, right, down = (
        camera.point(np.array([u + corner[1], v + corner[0]]), 1.0 / each)
        for corner, each in zip(corners, inverse, strict=True)
    )
    normal = np.cross(right - first, down - first)
    upwards = abs(float(direction_to_frame(normal / np.linalg.norm(normal), "world")[2]))
    steep = math.acos(min(1.0, upwards))
    if steep > steepest:
        raise InputError(
            f"the surface there is inclined by {math.degrees(steep):.0f} deg; click on a level one, such as the table"
        )
    return np.asarray(first, dtype=float)
