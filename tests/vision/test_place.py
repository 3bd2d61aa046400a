"""Where a click puts an object down, in a rendered picture: the table's true height, and every wrong click."""

import math

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.vision.camera import camera_pose, to_frame
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.place import level_place
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect
from hydrolek_drake.workcell.table import make_loose_pipe, make_table

TABLE = make_table()


@pytest.fixture(scope="module")
def scene():
    pipe = make_loose_pipe(TABLE)
    frame = SimulatedKinect(pipe, np.random.default_rng(1), table=TABLE).read()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    return (
        frame,
        snapshot,
        select_object(snapshot, tuple(_pixel(pipe.point + np.array([0, 0, 0.1]), frame.camera))).mask,
    )


def _pixel(point, camera):
    pose = camera_pose()
    return camera.pixel((in_frame(point, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3])


def _place(scene, click):
    frame, snapshot, selected = scene
    return level_place(snapshot, selected, click, frame.camera, around=12, steepest=math.radians(20.0))


@pytest.mark.parametrize("point", [(1.85, -0.25), (1.80, -0.4), (1.85, 0.2)])
def test_a_click_on_the_table_gives_the_point_that_is_there(scene, point):
    wanted = np.array([*point, TABLE.top[2]])
    found = to_frame(_place(scene, _pixel(wanted, scene[0].camera)), "world")
    np.testing.assert_allclose(found[1:], wanted[1:], atol=0.005)
    assert found[0] == pytest.approx(wanted[0], abs=0.02)  # seen at a grazing angle


def test_wrong_clicks_say_what_is_wrong(scene):
    camera = scene[0].camera
    on_pipe = _pixel(make_loose_pipe(TABLE).point, camera)
    for click, message in [
        ((700.0, 10.0), "outside the picture"),
        (on_pipe, "on the pipe itself"),
        ((60.0, 40.0), "nothing within reach"),
    ]:
        with pytest.raises(InputError, match=message):
            _place(scene, click)


def test_a_steep_surface_is_no_place():
    """The clamped pipe's own side, with nothing selected."""
    pipe = make_loose_pipe(TABLE)
    frame = SimulatedKinect(pipe, np.random.default_rng(1)).read()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    nothing = np.zeros(snapshot.mask.shape, bool)
    with pytest.raises(InputError, match=r"inclined by \d\d deg; click on a level one"):
        level_place(snapshot, nothing, _pixel(pipe.point, frame.camera), frame.camera, around=8, steepest=0.3)
