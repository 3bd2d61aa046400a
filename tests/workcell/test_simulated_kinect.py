"""The rendered camera: where things are in its picture is where they are in the world."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.vision.camera import camera_pose, thesis_camera, to_frame
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect


@pytest.fixture(scope="module")
def kinect():
    return SimulatedKinect(make_pipe([1.77, 0.05, 0.9], [0, 0, 1]), np.random.default_rng(1))


def test_pipe_is_rendered_where_it_stands(kinect):
    """The nearest point of a vertical pipe: its axis less the radius; silhouette as wide as the tangents."""
    _, depth = kinect.exact()
    camera, pipe = thesis_camera(), kinect.scene.pipe
    middle = in_frame(pipe.point, given_in="world", wanted_in="plate") - camera_pose()[:3, 3]
    across, ahead = -middle[1], middle[0]
    row = depth[100]
    seen = np.flatnonzero(row < 1.6)
    distance = np.hypot(across, ahead)
    half, bearing = np.arcsin(pipe.radius / distance), np.arctan2(across, ahead)
    edges = camera.focal_x * np.tan([bearing - half, bearing + half]) + camera.centre_x
    np.testing.assert_allclose([seen.min(), seen.max()], edges, atol=1.5)  # VTK's cylinder has facets
    points = camera.point(np.column_stack([seen, np.full(len(seen), 100)]), row[seen])
    off = np.hypot(points[:, 0] - across, points[:, 2] - ahead)
    np.testing.assert_allclose(off[2:-2], pipe.radius, atol=0.002)


def test_a_point_of_the_hand_is_seen_where_the_kinematics_say(kinect):
    """The pixel of the wrist shows a surface of the hand, in front of it by its thickness at most."""
    angles = home_posture()
    angles[:7] = np.radians([20, 20, -20, 0, -40, 0, 40])
    kinect.stand(angles)
    _, depth = kinect.exact()
    kinect.stand(home_posture())
    tool = tool_pose(angles[:6])
    wrist = tool[:3, 3] - 0.2 * tool[:3, 0]
    on_plate = in_frame(wrist, given_in="right_base", wanted_in="plate")
    in_camera = (on_plate - camera_pose()[:3, 3]) @ camera_pose()[:3, :3]
    u, v = np.round(thesis_camera().pixel(in_camera)).astype(int)
    surface = thesis_camera().point([u, v], depth[v, u])
    assert np.linalg.norm(to_frame(surface, "right_base") - wrist) < 0.15


def test_frame_has_the_sensors_size_noise_and_shadow(kinect):
    frame = kinect.read()
    assert frame.colour.shape == (480, 640, 3) and frame.depth.dtype == np.uint16
    _, exact = kinect.exact()
    read = frame.depth > 0
    error = frame.depth[read] * 1e-3 - exact[read]
    assert 0.001 < np.median(np.abs(error)) < 0.02
    row = exact[100]
    left = np.flatnonzero(row < 1.6).min()
    assert not frame.depth[100, left - 10 : left - 1].any()  # the projector's shadow
    assert frame.depth[100, left + 8] > 0


def test_poor_light_darkens_the_picture_and_leaves_the_depth():
    kinects = [SimulatedKinect(make_pipe(), np.random.default_rng(1), brightness=b) for b in (1.0, 0.1)]
    bright, dark = (kinect.read() for kinect in kinects)
    assert dark.colour.mean() < 0.2 * bright.colour.mean()
    np.testing.assert_array_equal(dark.depth, bright.depth)


def test_bad_angles_and_pipes_are_refused(kinect):
    with pytest.raises(InputError, match="14 finite"):
        kinect.stand(np.zeros(7))
    with pytest.raises(InputError, match="positive sizes"):
        make_pipe(radius=-1.0)
    with pytest.raises(InputError, match="three numbers"):
        make_pipe(point=[1.0, np.nan, 0.0])
