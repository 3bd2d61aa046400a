"""Pixel to point and back; (5.2) as printed, and by how much it differs from the pinhole camera."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import (
    camera_pose,
    checked_frame,
    direction_to_frame,
    recorded_camera,
    thesis_camera,
    thesis_target,
    to_frame,
)


@pytest.mark.parametrize("camera", [recorded_camera(), thesis_camera()])
def test_point_and_pixel_are_inverse(camera):
    rng = np.random.default_rng(1)
    pixels, depth = rng.uniform([0, 0], [639, 479], (50, 2)), rng.uniform(0.5, 2.0, 50)
    np.testing.assert_allclose(camera.pixel(camera.point(pixels, depth)), pixels, atol=1e-9)
    np.testing.assert_allclose(camera.point(pixels, depth)[:, 2], depth)


def test_thesis_camera_spans_57_by_43_degrees():
    camera = thesis_camera()
    corner = camera.point([639.5, 479.5], 1.0)  # the last pixel's outer corner
    np.testing.assert_allclose(np.degrees(np.arctan(corner[:2])) * 2, [57.0, 43.0], atol=1e-9)


def test_5_2_as_printed():
    """By hand: 100 px to the right and 50 down of (320, 240) at 1.2 m."""
    expected = [1.2 * np.tan(np.radians(8.9)) + 0.275, 1.2 * np.tan(np.radians(4.45)), 1.2]
    np.testing.assert_allclose(thesis_target([420, 290], 1.2), expected, rtol=1e-12)


def test_5_2_misses_the_pinhole_by_18_mm_at_most():
    """docs/evidence/vision.md: equal angles a pixel against the pinhole camera with the same field of view, at 1 m."""
    camera, middle = thesis_camera(), np.array([320.0, 240.0])
    columns = np.arange(0, 640, 5.0)
    printed = thesis_target(np.stack([columns, np.full_like(columns, 240)], -1), 1.0)[:, 0] - 0.275
    true = camera.point(np.stack([columns, np.full_like(columns, 240)], -1), 1.0)[:, 0]
    true = true - camera.point(middle, 1.0)[0]
    largest = np.abs(printed - true).max()
    assert largest == pytest.approx(0.018, abs=0.001)
    assert abs(printed[64] - true[64]) < 1e-6  # in the middle both agree


def test_camera_looks_forward_from_between_the_arms():
    """A point 1 m ahead lies 1 m before both shoulders, between them: 0.3 m to the left of the right one."""
    np.testing.assert_allclose(to_frame([0, 0, 1.0], "right_base"), [1.0, 0.0, -0.3], atol=1e-9)
    np.testing.assert_allclose(to_frame([0, 0, 1.0], "left_base"), [1.0, 0.0, 0.3], atol=1e-9)
    np.testing.assert_allclose(direction_to_frame([0, 1.0, 0], "right_base"), [0, -1.0, 0], atol=1e-12)
    np.testing.assert_allclose(direction_to_frame([1.0, 0, 0], "right_base"), [0, 0, 1.0], atol=1e-12)
    rotation = camera_pose()[:3, :3]
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(rotation) == pytest.approx(1.0)


def test_pictures_of_another_camera_are_refused():
    camera = recorded_camera()
    colour, depth = np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16)
    checked_frame(colour, depth, camera)
    with pytest.raises(InputError, match="480 x 640 x 3"):
        checked_frame(colour[:100], depth, camera)
    with pytest.raises(InputError, match="16 bits"):
        checked_frame(colour, depth.astype(np.uint8), camera)
