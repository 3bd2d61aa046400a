"""The sensor's noise, steps, holes and shadow against what the parameters say."""

import numpy as np
import pytest

from hydrolek_drake.vision.camera import thesis_camera
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.vision.kinect_noise import kinect_depth, projector_shadow

CAMERA = thesis_camera()
VALUES = kinect_entries("camera")


@pytest.mark.parametrize("distance", [0.8, 1.4, 3.0])
def test_noise_grows_with_the_square_of_the_distance(distance):
    flat = np.full((480, 640), distance)
    measured = kinect_depth(flat, CAMERA, np.random.default_rng(1))
    read = measured[measured > 0] * 1e-3
    step = distance**2 * VALUES["disparity_step"] / (CAMERA.focal_x * VALUES["baseline"])
    expected = np.hypot(VALUES["depth_noise"] * distance**2, step / np.sqrt(12))
    assert read.std() == pytest.approx(expected, rel=0.2)  # steps and noise are not independent where alike
    assert read.mean() == pytest.approx(distance, abs=0.5 * expected)
    assert (measured == 0).mean() == pytest.approx(VALUES["dropout"], rel=0.2)


def test_depth_comes_in_steps_of_disparity():
    measured = kinect_depth(np.full((480, 640), 1.2), CAMERA, np.random.default_rng(1))
    disparity = CAMERA.focal_x * VALUES["baseline"] / (np.unique(measured[measured > 0]) * 1e-3)
    steps = disparity / VALUES["disparity_step"]
    np.testing.assert_allclose(steps, steps.round(), atol=0.2)


def test_nothing_is_read_out_of_range():
    for distance in (0.3, 5.0, np.inf):
        depth = np.full((480, 640), distance)
        assert not kinect_depth(depth, CAMERA, np.random.default_rng(1)).any()


def test_shadow_lies_left_of_a_near_object_and_is_as_wide_as_the_parallax():
    """Width f b (1/Z_near - 1/Z_far) px."""
    depth = np.full((480, 640), 2.0)
    depth[:, 300:340] = 1.0
    shadow = projector_shadow(depth, CAMERA, VALUES["baseline"])
    width = CAMERA.focal_x * VALUES["baseline"] * (1 / 1.0 - 1 / 2.0)
    columns = np.flatnonzero(shadow[240])
    assert columns.max() == 299 and len(columns) == pytest.approx(width, abs=1.5)


def test_a_surface_seen_at_a_grazing_angle_has_holes():
    """The plane Z = 1.5 m + steep X: the angle between its normal and each column's ray decides."""
    x = (np.arange(640) - CAMERA.centre_x) / CAMERA.focal_x
    steep = np.tan(np.radians(84.0))
    with np.errstate(divide="ignore"):
        depth = 1.5 / (1 - steep * x)
    depth = np.where((depth > 0.55) & (depth < 3.5), depth, np.inf)
    angle = np.degrees(np.arccos(np.abs(steep * x - 1) / np.hypot(steep, 1) / np.hypot(x, 1)))
    measured = kinect_depth(np.broadcast_to(depth, (480, 640)), CAMERA, np.random.default_rng(1))[240]
    limit = np.degrees(VALUES["grazing_angle"])
    inside = np.isfinite(depth) & np.roll(np.isfinite(depth), 2) & np.roll(np.isfinite(depth), -2)
    assert not measured[inside & (angle > limit + 1)].any()
    assert (measured[inside & (angle < limit - 1)] > 0).mean() > 0.95
