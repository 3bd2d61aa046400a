"""One planned task for all tests: from a rendered frame, as the console plans it."""

import numpy as np
import pytest

from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.plan import plan_task
from hydrolek_drake.vision.camera import camera_pose
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect


def pixel_of(point, camera):
    pose = camera_pose()
    on_plate = in_frame(point, given_in="world", wanted_in="plate")
    return camera.pixel((on_plate - pose[:3, 3]) @ pose[:3, :3])


def plan_for(pipe, grasp, cut, grasping="right"):
    frame = SimulatedKinect(pipe, np.random.default_rng(1)).read()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    clicks = [pixel_of(pipe.point + along * pipe.axis, frame.camera) for along in (grasp, cut)]
    selected = select_object(snapshot, tuple(clicks[0]))
    pixels = pixel_targets(snapshot, selected, *clicks, frame.camera)
    targets = pipe_targets(snapshot, selected, pixels, frame.camera)
    return plan_task(targets, frame.camera, home_posture(), np.random.default_rng(1), grasping=grasping)


@pytest.fixture(scope="session")
def plan():
    return plan_for(make_pipe(), -0.05, 0.12)


@pytest.fixture(scope="session")
def planner():
    return plan_for
