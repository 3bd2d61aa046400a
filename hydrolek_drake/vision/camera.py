"""Pixel and depth to a point: the pinhole model, and thesis equation (5.2) as printed.

Camera frame C: X to the right, Y down, Z forwards, in m; depth is along Z, as the Kinect gives it (5.2.6).
"""

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.vision.configuration import kinect_entries

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CameraModel:
    """A pinhole camera without distortion.

    Attributes:
        width: Pixels across.
        height: Pixels down.
        focal_x: Focal length in px, across.
        focal_y: Focal length in px, down.
        centre_x: Principal point in px.
        centre_y: Principal point in px.
    """

    width: int
    height: int
    focal_x: float
    focal_y: float
    centre_x: float
    centre_y: float

    def point(self, pixel: ArrayLike, depth: ArrayLike) -> Array:
        """Points in the camera frame, in m: X = Z (u - c_x) / f_x, Y = Z (v - c_y) / f_y.

        Args:
            pixel: u to the right and v down, in px, shape (..., 2).
            depth: Z in m, shape (...).

        Returns:
            Points, shape (..., 3).
        """
        pixel, depth = np.asarray(pixel, dtype=float), np.asarray(depth, dtype=float)
        x = (pixel[..., 0] - self.centre_x) / self.focal_x * depth
        y = (pixel[..., 1] - self.centre_y) / self.focal_y * depth
        return np.stack(np.broadcast_arrays(x, y, depth), axis=-1)

    def pixel(self, point: ArrayLike) -> Array:
        """Where points (..., 3) of the camera frame are seen, in px, shape (..., 2)."""
        point = np.asarray(point, dtype=float)
        across, down = point[..., 0] / point[..., 2], point[..., 1] / point[..., 2]
        return np.stack([self.focal_x * across + self.centre_x, self.focal_y * down + self.centre_y], axis=-1)

    def holds(self, pixel: ArrayLike) -> bool:
        """Whether a pixel lies within the picture."""
        u, v = np.asarray(pixel, dtype=float)
        return bool(-0.5 <= u < self.width - 0.5 and -0.5 <= v < self.height - 0.5)


@cache
def recorded_camera() -> CameraModel:
    """The sensor as its factory calibrates it, 525 px: that of recorded frames."""
    values = kinect_entries("camera")
    width, height = int(values["width"]), int(values["height"])
    focal = values["focal_length"]
    return CameraModel(width, height, focal, focal, (width - 1) / 2, (height - 1) / 2)


@cache
def thesis_camera() -> CameraModel:
    """The pinhole camera with the thesis's field of view, 57 x 43 degrees: that of the simulation."""
    values = kinect_entries("camera")
    width, height = int(values["width"]), int(values["height"])
    focal_x = width / 2 / math.tan(values["field_of_view_x"] / 2)
    focal_y = height / 2 / math.tan(values["field_of_view_y"] / 2)
    return CameraModel(width, height, focal_x, focal_y, (width - 1) / 2, (height - 1) / 2)


def thesis_target(pixel: ArrayLike, depth: ArrayLike) -> Array:
    """Thesis equation (5.2) as printed: tangent of 0.089 degrees a pixel, 275 mm beside the camera.

    X_t = Z tan(0.089 (x - 320)) + 275 mm,  Y_t = Z tan(0.089 (y - 240)),  Z_t = Z

    Two things differ from the real camera, and are kept here as printed: equal angles a pixel are not a
    pinhole's (docs/evidence/vision.md has the difference), and the signs. Pixels count downwards, so Y_t is positive
    below the centre; and a point in the middle of the picture lies 275 mm to the *left* of the right shoulder.

    Args:
        pixel: x to the right and y down, in px, shape (..., 2).
        depth: Z in m, shape (...).

    Returns:
        X_t to the right, Y_t, Z_t forwards, in m, shape (..., 3).
    """
    values = kinect_entries("thesis")
    pixel, depth = np.asarray(pixel, dtype=float), np.asarray(depth, dtype=float)
    angle = values["degrees_per_pixel"]  # rad by now
    x = depth * np.tan(angle * (pixel[..., 0] - values["centre_x"])) + values["shoulder_offset"]
    y = depth * np.tan(angle * (pixel[..., 1] - values["centre_y"]))
    return np.stack(np.broadcast_arrays(x, y, depth), axis=-1)


@cache
def camera_pose() -> Array:
    """Pose of the camera in the plate's frame (x forward, y left, z up), shape (4, 4), in m."""
    mount = kinect_entries("mount")
    tilt = mount["tilt"]
    pose = np.eye(4)
    pose[:3, 0] = (0.0, -1.0, 0.0)
    pose[:3, 1] = (-math.sin(tilt), 0.0, -math.cos(tilt))
    pose[:3, 2] = (math.cos(tilt), 0.0, -math.sin(tilt))
    pose[:3, 3] = (mount["x"], mount["y"], mount["z"])
    pose.flags.writeable = False
    return pose


def to_frame(points: ArrayLike, frame: str) -> Array:
    """Points (..., 3) of the camera frame in a fixed frame of the machine, such as `right_base`, in m.

    Raises:
        InputError: Unknown frame.
    """
    pose = camera_pose()
    on_plate = np.asarray(points, dtype=float) @ pose[:3, :3].T + pose[:3, 3]
    return in_frame(on_plate, given_in="plate", wanted_in=frame)


def direction_to_frame(vectors: ArrayLike, frame: str) -> Array:
    """Directions (..., 3) of the camera frame in a fixed frame of the machine.

    Raises:
        InputError: Unknown frame.
    """
    vectors = np.asarray(vectors, dtype=float)
    return to_frame(vectors, frame) - to_frame(np.zeros(3), frame)


def checked_frame(colour: NDArray[np.uint8], depth: NDArray[np.uint16], camera: CameraModel) -> None:
    """Refuse pictures that are not the camera's.

    Raises:
        InputError: Wrong size or type.
    """
    if colour.shape != (camera.height, camera.width, 3) or colour.dtype != np.uint8:
        raise InputError(
            f"colour picture is {colour.shape} {colour.dtype}; the camera gives "
            f"{camera.height} x {camera.width} x 3 of 8 bits"
        )
    if depth.shape != (camera.height, camera.width) or depth.dtype != np.uint16:
        raise InputError(
            f"depth picture is {depth.shape} {depth.dtype}; the camera gives "
            f"{camera.height} x {camera.width} of 16 bits, in mm"
        )
