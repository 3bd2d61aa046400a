"""Frames of a folder, missing cameras, alignment and mirroring."""

import cv2
import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import FolderSource, LiveCamera, aligned_depth, flipped


@pytest.fixture
def folder(tmp_path):
    for name, level in (("b", 20), ("a", 10)):
        cv2.imwrite(str(tmp_path / f"{name}_color.png"), np.full((480, 640, 3), level, np.uint8))
        cv2.imwrite(str(tmp_path / f"{name}_depth.png"), np.full((480, 640), 1000 + level, np.uint16))
    return tmp_path


def test_frames_come_in_the_order_of_their_names_again_and_again(folder):
    source = FolderSource(folder)
    frames = [source.read() for _ in range(3)]
    assert [frame.name for frame in frames] == ["a", "b", "a"]
    assert frames[1].depth[0, 0] == 1020 and frames[1].colour[0, 0, 0] == 20


def test_what_is_missing_or_wrong_is_named(folder, tmp_path_factory):
    with pytest.raises(InputError, match="not a folder"):
        FolderSource(folder / "nowhere")
    with pytest.raises(InputError, match=r"holds no NAME_color\.png"):
        FolderSource(tmp_path_factory.mktemp("empty"))
    with pytest.raises(InputError, match="choose from a, b"):
        FolderSource(folder).named("c")
    (folder / "a_depth.png").unlink()
    with pytest.raises(InputError, match=r"a_depth\.png is missing"):
        FolderSource(folder).read()
    cv2.imwrite(str(folder / "b_depth.png"), np.zeros((10, 10), np.uint16))
    with pytest.raises(InputError, match=r"b: depth picture is \(10, 10\)"):
        FolderSource(folder).named("b")


def test_without_a_camera_the_reason_is_given():
    with pytest.raises(InputError, match="no depth camera 7 answers"):
        LiveCamera(7)


def test_mirroring_twice_gives_the_picture_back():
    picture = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
    np.testing.assert_array_equal(flipped(picture)[:, 0], picture[:, 1])
    np.testing.assert_array_equal(flipped(flipped(picture)), picture)


def test_alignment_moves_a_point_by_its_parallax():
    """A sensor 25 mm to the right of the colour camera: a point at 1 m shifts by f b / Z = 13 px."""
    camera = recorded_camera()
    depth = np.zeros((480, 640), np.uint16)
    depth[200, 300], depth[201, 300] = 1000, 2000
    pose = np.eye(4)
    pose[0, 3] = 0.025
    aligned = aligned_depth(depth, camera, camera, pose)
    shift = 525 * 0.025
    assert aligned[200, round(300 + shift)] == 1000 and aligned[201, round(300 + shift / 2)] == 2000
    assert (aligned > 0).sum() == 2


def test_alignment_keeps_the_nearest_of_two_points():
    camera = recorded_camera()
    depth = np.zeros((480, 640), np.uint16)
    depth[100, 100], depth[100, 101] = 1500, 1000
    squeezed = np.diag([0.0, 0.0, 1.0, 1.0])  # all onto the axis
    aligned = aligned_depth(depth, camera, camera, squeezed)
    assert aligned[aligned > 0].tolist() == [1000]
