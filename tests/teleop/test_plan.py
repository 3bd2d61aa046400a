"""A task planned from a picture: the true pipe is grasped and cut, whatever its attitude."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import direction_in_frame, in_frame
from hydrolek_drake.standing.base import Placement, drawn_boom_angle
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.trajectory import joint_speeds


def _tool(posture, side):
    angles = posture[:6] if side == "right" else posture[7:13]
    pose, base = tool_pose(angles), f"{side}_base"
    return (
        in_frame(pose[:3, 3], given_in=base, wanted_in="world"),
        direction_in_frame(pose[:3, 0], given_in=base, wanted_in="world"),
    )


def _end(plan, name):
    trajectory = plan.steps[STEPS.index(name)].trajectory
    return trajectory.value(trajectory.end_time())[:, 0]


def _off_axis(point, pipe):
    offset = point - pipe.point
    return np.linalg.norm(offset - (offset @ pipe.axis) * pipe.axis)


@pytest.mark.parametrize(
    ("axis", "along"),
    [((0, 0, 1), (-0.05, 0.12)), ((0, 1, 0), (-0.05, 0.15)), ((0.2, 0.4, 1), (-0.05, 0.12))],
)
@pytest.mark.thorough(but=2)
def test_the_true_pipe_is_grasped_and_cut_from_a_noisy_picture(planner, axis, along):
    pipe = make_pipe(axis=axis)
    plan = planner(pipe, *along)
    point, _ = _tool(_end(plan, "grasp"), "right")
    assert _off_axis(point, pipe) < 0.005  # what vision and kinematics may be off together
    blade = kinect_entries("targets")["blade_reach"]
    trajectory = plan.steps[STEPS.index("cut")].trajectory
    tips = []
    for t in np.linspace(0, trajectory.end_time(), 200):
        tool, direction = _tool(trajectory.value(t)[:, 0], "left")
        tips.append(tool + blade * direction)
    assert _off_axis(tips[0], pipe) > pipe.radius and _off_axis(tips[-1], pipe) > pipe.radius
    assert min(_off_axis(tip, pipe) for tip in tips) < 0.005  # through the middle of the pipe


def test_steps_join_and_stay_within_the_speeds(plan):
    assert tuple(step.name for step in plan.steps) == STEPS
    before, speed = home_posture(), joint_speeds()[0]
    for step in plan.steps:
        first, last = step.trajectory.value(0.0)[:, 0], _end(plan, step.name)
        # opening a gripper is left to the next step's path
        np.testing.assert_allclose(first[:6], before[:6], atol=1e-6)
        np.testing.assert_allclose(first[7:13], before[7:13], atol=1e-6)
        for t in np.linspace(0, step.trajectory.end_time(), 50):
            assert np.all(np.abs(step.trajectory.EvalDerivative(t, 1)[:, 0]) <= speed * (1 + 1e-9))
        before = last
    np.testing.assert_allclose(before[7:13], home_posture()[7:13], atol=1e-9)  # the cutting arm is home


def test_no_step_touches_the_true_pipe_or_the_other_arm(plan):
    """Bare shapes; the gripper that grasps may touch the pipe from the grasp on."""
    pipe = make_pipe()
    free, holding = CollisionWorld(pipe, padding=0.0), CollisionWorld(pipe, padding=0.0, holding=("right",))
    for step in plan.steps:
        world = free if step.name == "approach" else holding
        for t in np.linspace(0, step.trajectory.end_time(), 60):
            posture = step.trajectory.value(t)[:, 0]
            assert world.free(posture), (step.name, world.touching(posture))


def test_the_other_way_round_the_left_arm_grasps(planner):
    plan = planner(make_pipe(), -0.05, 0.12, grasping="left")
    point, _ = _tool(_end(plan, "grasp"), "left")
    assert _off_axis(point, make_pipe()) < 0.005 and plan.cut.side == "right"


def test_from_a_place_to_stand_the_picture_is_enough_to_plan(planner):
    """The pipe out of reach from where the machine stands is grasped and cut from a picture taken at the place."""
    pipe = make_pipe([3.2, 0.9, 1.06])
    with pytest.raises(InputError):
        planner(pipe, -0.05, 0.12)
    seen = Placement(1.33, 0.9, 0.0, drawn_boom_angle()).pipe_seen(pipe)
    plan = planner(seen, -0.05, 0.12)
    point, _ = _tool(_end(plan, "grasp"), "right")
    assert _off_axis(point, seen) < 0.005
