"""What a Kinect makes of a perfect depth picture: noise, steps, holes, and the projector's shadow."""

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.vision.camera import CameraModel
from hydrolek_drake.vision.configuration import kinect_entries

Floats = NDArray[np.float64]


def kinect_depth(depth: Floats, camera: CameraModel, generator: np.random.Generator) -> NDArray[np.uint16]:
    """Depth as the sensor reports it.

    - noise: standard deviation proportional to the squared depth (even in disparity);
    - steps: disparity f b / Z is counted in eighths of a pixel;
    - holes: out of range, surfaces seen at a grazing angle, and a few pixels anywhere;
    - shadow: where an object keeps the projector's pattern from what is behind it. The projector sits to the right
      of the camera as seen, so that shadows fall to the left.

    Args:
        depth: Exact depth along the optical axis in m, 0 or infinite for nothing, shape (h, w).
        camera: The camera.
        generator: For noise and holes.

    Returns:
        Depth in mm, 0 for no reading, shape (h, w).
    """
    values = kinect_entries("camera")
    seen = np.isfinite(depth) & (depth >= values["nearest"]) & (depth <= values["farthest"])
    exact = np.where(seen, depth, values["farthest"])
    seen &= ~projector_shadow(exact, camera, values["baseline"])
    seen &= ~_grazing(exact, camera, values["grazing_angle"])
    seen &= generator.random(depth.shape) >= values["dropout"]
    noisy = exact + generator.normal(size=depth.shape) * values["depth_noise"] * exact**2
    span = camera.focal_x * values["baseline"]
    steps = np.maximum(1.0, np.round(span / np.maximum(noisy, 0.1) / values["disparity_step"]))
    reported = span / (steps * values["disparity_step"])
    return np.where(seen, np.round(1e3 * reported), 0).astype(np.uint16)


def projector_shadow(depth: Floats, camera: CameraModel, baseline: float) -> NDArray[np.bool_]:
    """Where the projector, `baseline` m to the right of the camera, sees something nearer instead.

    A point at column u is column u - f b / Z for the projector. Its columns must rise with the camera's; where a
    point further right falls back to the left of it, that point is in the way.
    """
    columns = np.arange(depth.shape[1]) - camera.focal_x * baseline / depth
    beyond = np.minimum.accumulate(columns[:, ::-1], axis=1)[:, ::-1]
    return columns > beyond + 0.5


def _grazing(depth: Floats, camera: CameraModel, largest: float) -> NDArray[np.bool_]:
    """Where the surface is seen at more than `largest` rad from its normal; by differences of inverse depth."""
    inverse = 1.0 / depth
    w_v, w_u = np.gradient(inverse)
    x = (np.arange(camera.width) - camera.centre_x) / camera.focal_x
    y = ((np.arange(camera.height) - camera.centre_y) / camera.focal_y)[:, np.newaxis]
    a, b = camera.focal_x * w_u, camera.focal_y * w_v
    c = inverse - x * a - y * b
    cosine = inverse / (np.sqrt(a * a + b * b + c * c) * np.sqrt(1.0 + x * x + y * y))
    return cosine < np.cos(largest)
