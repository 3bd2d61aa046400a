"""Pictures show the machine."""

import cv2
import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.visualization.pictures import camera_pose, render_scene, write_picture

SMALL = {"width": 160, "height": 100}


def test_machine_is_yellow_and_grey_and_in_the_picture():
    picture = render_scene(**SMALL)
    assert picture.shape == (100, 160, 3) and picture.dtype == np.uint8
    red, green, blue = (picture[..., channel].astype(int) for channel in range(3))
    yellow = (red > 100) & (red > green) & (green > 2 * blue)
    dark = picture.max(axis=2) < 110
    assert yellow.mean() > 0.01
    assert dark.mean() > 0.03


def test_moving_a_joint_changes_the_picture_and_the_same_angles_give_the_same_one():
    still = render_scene(**SMALL)
    np.testing.assert_array_equal(still, render_scene(**SMALL))
    moved = render_scene({"right_j2": 0.0}, **SMALL)
    assert np.any(still != moved)


def test_camera_looks_along_z_with_the_world_upright():
    pose = camera_pose([3.0, 1.0, 2.0], [0.0, 0.0, 0.5])
    forward = pose.rotation().col(2)
    np.testing.assert_allclose(forward, np.array([-3.0, -1.0, -1.5]) / np.sqrt(12.25), atol=1e-12)
    assert pose.rotation().col(1)[2] < 0  # y of the camera points down
    assert pose.rotation().col(0)[2] == pytest.approx(0.0, abs=1e-15)
    with pytest.raises(InputError, match="straight up or down"):
        camera_pose([0, 0, 2], [0, 0, 0])


def test_picture_is_written_as_it_is(tmp_path):
    picture = np.random.default_rng(7).integers(0, 256, (12, 20, 3), dtype=np.uint8)
    write_picture(tmp_path / "scene.png", picture)
    np.testing.assert_array_equal(cv2.imread(str(tmp_path / "scene.png"))[..., ::-1], picture)
    assert [path.name for path in tmp_path.iterdir()] == ["scene.png"]


def test_unknown_joint_is_refused():
    with pytest.raises(InputError, match=r"'right_j9'.*right_j1"):
        render_scene({"right_j9": 0.1}, **SMALL)
