"""Pick and place planned from a picture: the true pipe is gripped, goes with the hand, ends at the place; refusals."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.place_plan import PLACE_STEPS, plan_place, plan_place_by_either
from hydrolek_drake.teleop.release import LET_GO_STEPS, pipe_after, plan_letting_go
from hydrolek_drake.teleop.target_selection.clicks import Clicks, Task
from hydrolek_drake.vision.camera import camera_pose
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import Fill
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import tool_in_world
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect
from hydrolek_drake.workcell.table import make_loose_pipe, make_table
from hydrolek_drake.workcell.trajectory import joint_speeds

TABLE = make_table()
LIFT = workcell_entries()["place"]["lift"][0]
PIPE = make_loose_pipe(TABLE)
GRASP = PIPE.point + np.array([0.0, 0.0, 0.2])
PLACE = np.array([1.85, 0.20, TABLE.top[2]])


def pixel(point, camera):
    pose = camera_pose()
    return camera.pixel((in_frame(point, given_in="world", wanted_in="plate") - pose[:3, 3]) @ pose[:3, :3])


def clicked(pipe, place, table=TABLE, grasp=GRASP):
    frame = SimulatedKinect(pipe, np.random.default_rng(1), table=table).read()
    clicks = Clicks(frame, Task.PLACE, default_settings())
    for point in (grasp - [0, 0, 0.05], grasp, place):
        clicks.click(*pixel(point, frame.camera), Fill.SURFACES)
    return clicks


def planned(clicks, plan=plan_place):
    return plan(clicks.targets, clicks.place, clicks.frame.camera, home_posture(), np.random.default_rng(1))


@pytest.fixture(scope="module")
def plan():
    return planned(clicked(PIPE, PLACE))


def _end(plan, name):
    trajectory = plan.steps[PLACE_STEPS.index(name)].trajectory
    return trajectory.value(trajectory.end_time())[:, 0]


def _carried_to(plan, posture):
    """The true pipe in the hand at a posture, taken at the end of the grasp."""
    (before, there), (turned, here) = (tool_in_world(q, "right") for q in (_end(plan, "close"), posture))
    turn = turned @ before.T
    return PIPE.moved(turn, here - turn @ there)


def test_the_true_pipe_ends_upright_close_above_the_place(plan):
    assert tuple(step.name for step in plan.steps) == PLACE_STEPS
    pipe = _carried_to(plan, _end(plan, "lower"))
    np.testing.assert_allclose(pipe.point[:2], PLACE[:2], atol=0.02)
    assert pipe.axis[2] > np.cos(np.radians(1.0))
    assert 0.0 <= pipe.lowest() - TABLE.top[2] < 0.03  # it is let go above the table, and not far


def test_lifting_is_straight_up(plan):
    trajectory = plan.steps[PLACE_STEPS.index("lift")].trajectory
    points = [
        tool_in_world(trajectory.value(t)[:, 0], "right")[1]
        for t in np.linspace(0, trajectory.end_time(), 20)
    ]
    beside = np.array(points)[:, :2] - points[0][:2]
    assert np.abs(beside).max() < 0.002
    assert points[-1][2] - points[0][2] == pytest.approx(LIFT, abs=1e-3)


def test_nothing_touches_the_true_table_the_other_arm_or_the_pipe_that_is_carried(plan):
    bare, carrying = (
        CollisionWorld(PIPE, padding=0.0, table=TABLE),
        CollisionWorld(None, padding=0.0, table=TABLE),
    )
    carrying.carry("right", _end(plan, "close"), PIPE.moved(np.eye(3), [0, 0, 0.001]))
    placed = CollisionWorld(_carried_to(plan, _end(plan, "lower")), padding=0.0, table=TABLE)
    for step in plan.steps:
        if step.name in ("grasp", "close", "open", "back off"):
            continue  # fingers reach into the pipe's outline there, as in the cut
        world = {"approach": bare, "home": placed}.get(step.name, carrying)
        for t in np.linspace(0, step.trajectory.end_time(), 60):
            posture = step.trajectory.value(t)[:, 0]
            assert world.free(posture), (step.name, world.touching(posture))


def test_a_carried_pipe_is_seen_to_touch_the_table_and_the_other_arm(plan):
    world = CollisionWorld(None, padding=0.0, table=TABLE.lowered(-0.05))
    posture = _end(plan, "close")
    assert world.free(posture)
    world.carry("right", posture, PIPE)
    assert not world.free(posture)


def test_steps_join_and_stay_within_the_speeds(plan):
    before, speed = home_posture(), joint_speeds()[0]
    for step in plan.steps:
        first = step.trajectory.value(0.0)[:, 0]
        np.testing.assert_allclose(first[:6], before[:6], atol=1e-6)
        np.testing.assert_array_equal(first[7:13], home_posture()[7:13])  # the other arm stands still
        for t in np.linspace(0, step.trajectory.end_time(), 50):
            assert np.all(np.abs(step.trajectory.EvalDerivative(t, 1)[:, 0]) <= speed * (1 + 1e-9))
        before = _end(plan, step.name)
    np.testing.assert_allclose(before, home_posture(), atol=1e-9)


def test_a_pipe_that_leaves_the_picture_is_not_carried():
    clamped = make_pipe()
    with pytest.raises(InputError, match="leaves the picture"):
        planned(clicked(clamped, PLACE))


def test_where_the_right_arm_cannot_the_left_one_does_it():
    place = np.array([1.95, 0.10, TABLE.top[2]])
    clicks = clicked(PIPE, place)
    with pytest.raises(InputError, match="the right arm cannot"):
        planned(clicks)
    plan = planned(clicks, plan_place_by_either)
    assert plan.grasp.side == "left"
    np.testing.assert_allclose(plan.placed.point[:2], place[:2], atol=0.02)


def test_a_place_out_of_reach_of_both_is_refused_with_both_reasons():
    far = make_table()
    pipe, place = make_loose_pipe(far), [2.05, 0.25, far.top[2]]
    with pytest.raises(InputError, match=r"the right arm cannot.*the left arm cannot"):
        planned(clicked(pipe, place), plan_place_by_either)


@pytest.mark.parametrize(
    ("step", "there"), [("lift", "hand"), ("approach", "stand"), ("home", "place"), ("", "place")]
)
def test_after_an_abort_it_is_known_where_the_pipe_is(plan, step, there):
    posture = _end(plan, "lift") if there == "hand" else home_posture()
    pipe = pipe_after(plan, step, posture)
    wanted = {
        "hand": plan.pipe.point + np.array([0, 0, LIFT]),
        "stand": plan.pipe.point,
        "place": plan.placed.point,
    }[there]
    np.testing.assert_allclose(pipe.point, wanted, atol=2e-3)


def test_aborted_on_the_way_the_gripper_opens_backs_off_and_both_arms_go_home(plan):
    release = plan_letting_go(plan, "carry", _end(plan, "lift"), np.random.default_rng(1))
    assert tuple(step.name for step in release.steps) == LET_GO_STEPS and not release.holds
    last = release.steps[-1].trajectory
    np.testing.assert_allclose(last.value(last.end_time())[:, 0], home_posture(), atol=1e-9)
