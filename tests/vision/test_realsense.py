"""A RealSense camera: what one has recorded is played through the code that a live one goes through."""

import sys

import numpy as np
import pytest
import realsense_stand_in as stand_in

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.vision import realsense
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.realsense import RealSenseCamera
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot

needs_package = pytest.mark.skipif(bool(stand_in.missing), reason=stand_in.missing or "-")


@pytest.fixture
def frames(pipe):
    """A pipe that goes to the right."""
    shots = [pipe([x, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4, noise=0.0015) for x in (-0.05, 0.0, 0.05)]
    return [Frame(colour, depth, recorded_camera(), "cast") for colour, depth, _ in shots]


@needs_package
def test_a_recording_is_played_frame_by_frame_and_again(tmp_path, frames):
    path = tmp_path / "pipe.db3"
    stand_in.record(path, frames)
    camera = RealSenseCamera(path)
    try:
        played = [camera.read() for _ in range(4)]
    finally:
        camera.close()
    for frame in played:
        assert any(
            np.array_equal(frame.colour, sent.colour) and np.array_equal(frame.depth, sent.depth)
            for sent in frames
        )
        assert frame.camera == recorded_camera()
    assert not np.array_equal(played[0].depth, played[1].depth)


@needs_package
def test_the_pipe_is_selected_on_it_by_the_command_too(tmp_path, frames, capsys):
    path = tmp_path / "pipe.db3"
    stand_in.record(path, frames[1:2])
    camera = RealSenseCamera(path)
    frame = camera.read()
    camera.close()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    selection = select_object(snapshot, (320, 240))
    wanted = frames[1].colour[:, :, 0] == 170
    assert (selection.mask & wanted).sum() / (selection.mask | wanted).sum() > 0.9
    assert run(["vision", str(path), "--click", "320", "240"]) == 0
    assert f"object: {selection.mask.sum()} px" in capsys.readouterr().out


@needs_package
def test_other_units_of_depth_and_orders_of_colours_and_mirrored_pictures_are_put_right(tmp_path, frames):
    path = tmp_path / "pipe.db3"
    stand_in.record(path, frames[:1], unit=2.5e-4, form="rgb8")
    camera = RealSenseCamera(path, flipped=True)
    frame = camera.read()
    camera.close()
    np.testing.assert_array_equal(frame.depth[:, ::-1], frames[0].depth)
    np.testing.assert_array_equal(frame.colour[:, ::-1], frames[0].colour)


@needs_package
def test_depth_from_beside_the_colour_camera_is_aligned_with_the_colour(tmp_path):
    """From 25 mm beside it a point at 1 m is 13 px off, as in `aligned_depth`."""
    depth = np.zeros((480, 640), np.uint16)
    depth[190:211, 290:311] = 1000
    frame = Frame(np.zeros((480, 640, 3), np.uint8), depth, recorded_camera(), "square")
    path = tmp_path / "square.db3"
    stand_in.record(path, [frame], baseline=0.025)
    camera = RealSenseCamera(path)
    aligned = camera.read().depth
    camera.close()
    middle = np.argwhere(aligned > 0).mean(axis=0)
    np.testing.assert_allclose(middle, [200.0, 300.0 + 525.0 * 0.025], atol=1.0)


@needs_package
def test_a_camera_that_is_lost_says_so_and_is_sought_again(tmp_path, frames):
    path = tmp_path / "pipe.db3"
    stand_in.record(path, frames[:2])
    camera = RealSenseCamera(path, again=False)
    with pytest.raises(InputError, match="gives no more frames"):
        for _ in range(4):
            camera.read()
    assert camera.read().depth.any()
    camera.close()


@needs_package
def test_no_camera_and_no_recording_are_one_line(tmp_path, capsys):
    broken = tmp_path / "broken.db3"
    broken.write_bytes(b"this is no recording")
    for source, message in (
        ("realsense", "no RealSense camera answers"),
        (str(tmp_path / "none.db3"), "does not exist"),
        (str(broken), "cannot be started"),
    ):
        assert run(["vision", source]) == 2
        error = capsys.readouterr().err
        assert message in error and len(error.strip().splitlines()) == 1


def test_without_the_package_it_is_said_how_to_get_it(monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "pyrealsense2", None)
    with pytest.raises(InputError, match=r"pip install 'hydrolek-drake\[realsense\]'"):
        realsense.RealSenseCamera()
    assert run(["teleop", "--plant", "simple", "--camera", "realsense"]) == 2
    error = capsys.readouterr().err
    assert "needs the package pyrealsense2" in error and len(error.strip().splitlines()) == 1
