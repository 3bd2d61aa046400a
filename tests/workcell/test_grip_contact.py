"""Forces between grippers and a pipe, by geometry and by equilibrium."""

from dataclasses import replace

import numpy as np
import pytest
from applied_forces import total_force
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.kinematics.arms import add_arms, arm_joint_names, position_indices
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.workcell.fingers import fingers
from hydrolek_drake.workcell.grip_contact import GripContact
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.table import make_table

STIFFNESS = workcell_entries()["contact"]["stiffness"]


@pytest.fixture(scope="module")
def plant():
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0)
    builder.Build()
    return arms.plant


def _state(plant, posture, speed=None):
    order = position_indices(plant, list(arm_joint_names()))
    q, v = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
    q[order] = posture
    if speed is not None:
        v[order] = speed
    return np.concatenate([q, v])


SEATED = 0.0055
"""Way in m that a closing jaw draws the hand until the fixed fingers, 2.6 mm off at first, press as well."""


def _pipe_in_the_gripper(posture, seated=SEATED):
    """A pipe along the jaws' axis, moved so far from the right tool point towards the fixed fingers."""
    pose = tool_pose(posture[:6])
    point = in_frame(pose[:3, 3] - seated * pose[:3, 1], given_in="right_base", wanted_in="world")
    origin = in_frame(pose[:3, 3], given_in="right_base", wanted_in="world")
    tip = in_frame(pose[:3, 3] + pose[:3, 2], given_in="right_base", wanted_in="world")
    return make_pipe(point, tip - origin)


def test_the_gripper_has_a_hand_two_pairs_of_fixed_fingers_and_a_moving_one_of_two_parts():
    for side in ("right", "left"):
        parts = fingers(side)
        assert [part.link for part in parts] == ["link6"] * 5 + ["jaw"] * 2
        assert parts[1].radius == pytest.approx(0.013)
        assert np.linalg.norm(parts[1].ends[1] - parts[1].ends[0]) == pytest.approx(0.143 - 0.026)


def test_far_from_the_pipe_there_is_no_force(plant):
    contact = GripContact(plant, make_pipe())
    assert not contact.touches(_state(plant, home_posture()))[1].any()


def test_a_pipe_about_the_grasp_point_stands_clear_of_an_open_gripper(plant):
    """A hand that presses against the pipe before it grasps is pushed off its set point."""
    clear = workcell_entries()["pipe"]["radius"] + 2.5e-3
    posture = home_posture()
    for radius, touched in ((clear, False), (clear + 0.5e-3, True)):
        pipe = replace(_pipe_in_the_gripper(posture, seated=0.0), radius=radius)
        assert GripContact(plant, pipe).touches(_state(plant, posture))[1].any() == touched


def test_an_open_jaw_is_free_and_a_closing_one_is_pushed_open(plant):
    posture = home_posture()
    contact = GripContact(plant, _pipe_in_the_gripper(posture))
    moving = [finger.link == "jaw" and side == "right" for side, finger in contact.fingers]
    assert not contact.touches(_state(plant, posture))[1][moving].any()
    sizes = []
    for degrees in (24.0, 20.0, 16.0):
        posture[6] = np.radians(degrees)
        forces = contact.touches(_state(plant, posture))[1][moving]
        sizes.append(np.linalg.norm(forces, axis=1).sum())
    assert 0.0 <= sizes[0] < sizes[1] < sizes[2] and sizes[2] > 1e3


def test_the_force_is_stiffness_times_depth_square_to_the_pipe_and_grows_while_it_deepens(plant):
    posture = home_posture()
    posture[6] = np.radians(18.0)
    pipe = _pipe_in_the_gripper(posture)
    contact = GripContact(plant, pipe)
    points, forces = contact.touches(_state(plant, posture))
    speed = np.zeros(14)
    speed[6] = -0.5
    closing = contact.touches(_state(plant, posture, speed))[1]
    opening = contact.touches(_state(plant, posture, -speed))[1]
    context = plant.CreateDefaultContext()
    plant.SetPositionsAndVelocities(context, _state(plant, posture))
    touched = 0
    for i, (side, finger) in enumerate(contact.fingers):
        if not forces[i].any():
            continue
        touched += 1
        assert side == "right"
        assert abs(forces[i] @ pipe.axis) < 1e-6 * np.linalg.norm(forces[i])
        pose = plant.EvalBodyPoseInWorld(context, plant.GetBodyByName(f"{side}_{finger.link}"))
        offset = pose @ points[i] - pipe.point
        distance = np.linalg.norm(offset - (offset @ pipe.axis) * pipe.axis)
        depth = pipe.radius + finger.radius - distance
        assert np.linalg.norm(forces[i]) == pytest.approx(STIFFNESS * depth, rel=1e-6)
        if finger.link == "jaw":
            sizes = [np.linalg.norm(each[i]) for each in (opening, forces, closing)]
            assert sizes[0] < sizes[1] < sizes[2]
    assert touched >= 2


def test_beyond_the_pipe_s_end_nothing_is_touched(plant):
    posture = home_posture()
    posture[6] = np.radians(18.0)
    pipe = _pipe_in_the_gripper(posture)
    assert GripContact(plant, pipe).touches(_state(plant, posture))[1].any()
    beside = make_pipe(pipe.point + 0.8 * pipe.axis, pipe.axis)
    assert not GripContact(plant, beside).touches(_state(plant, posture))[1].any()


def _loose(plant, posture, jaw_deg):
    """A closed right gripper around a loose pipe at its tool, its context, and what stands below."""
    posture = posture.copy()
    posture[6] = np.radians(jaw_deg)
    pipe = _pipe_in_the_gripper(posture)
    table = replace(make_table(), top=np.array([pipe.point[0], pipe.point[1], pipe.lowest()]))
    contact = GripContact(plant, pipe, table)
    simulator = Simulator(contact)
    contact.plant_state.FixValue(simulator.get_mutable_context(), _state(plant, posture))
    simulator.AdvanceTo(0.05)
    return contact, simulator, pipe


def test_a_held_pipe_adds_its_weight_at_its_middle_and_nothing_else(plant):
    """What the finger presses is held against by the hand: forces and moments cancel but for the weight."""
    posture = home_posture()
    contact, simulator, pipe = _loose(plant, posture, 18.0)
    context = simulator.get_mutable_context()
    assert contact.pipe_in(context).holder == "right"
    assert contact.grip_force.Eval(context)[0] > 1e3 and contact.grip_force.Eval(context)[1] == 0.0
    posture[6] = np.radians(18.0)
    force, moment = total_force(plant, contact.contact_force.Eval(context), _state(plant, posture))
    weight = np.array([0.0, 0.0, -workcell_entries()["loose_pipe"]["mass"] * 9.81])
    np.testing.assert_allclose(force, weight, atol=1e-6)
    np.testing.assert_allclose(moment, np.cross(pipe.point, weight), atol=1e-6)


def test_a_held_pipe_goes_with_the_hand_and_is_dropped_when_the_jaw_opens(plant):
    posture = home_posture()
    contact, simulator, pipe = _loose(plant, posture, 18.0)
    context = simulator.get_mutable_context()
    turn = np.radians(10.0)
    posture[[1, 6]] += [turn, np.radians(18.0 - 40.0)]  # the arm up
    contact.plant_state.FixValue(context, _state(plant, posture))
    place = contact.pipe_place.Eval(context)
    lifted = np.linalg.norm(place[:3] - pipe.point)
    shoulder = in_frame([0.07, 0.0, 0.0], given_in="right_base", wanted_in="world")
    assert lifted == pytest.approx(2 * np.sin(turn / 2) * np.linalg.norm(pipe.point - shoulder), rel=0.05)
    grip = contact.grip_force.Eval(context)[0]
    simulator.AdvanceTo(0.10)
    assert contact.grip_force.Eval(context)[0] == pytest.approx(grip)  # as firm as before
    posture[6] = np.radians(40.0)
    contact.plant_state.FixValue(context, _state(plant, posture))
    simulator.AdvanceTo(1.5)
    loose = contact.pipe_in(context)
    assert loose.holder == "" and loose.falling == 0.0
    assert loose.pipe.lowest() in (pytest.approx(pipe.lowest(), abs=1e-9), pytest.approx(0.0, abs=1e-9))


def test_a_loose_pipe_that_only_the_fixed_fingers_touch_is_not_held(plant):
    contact, simulator, pipe = _loose(plant, home_posture(), 40.0)
    context = simulator.get_mutable_context()
    assert contact.pipe_in(context).holder == ""
    np.testing.assert_allclose(contact.pipe_place.Eval(context)[:3], pipe.point, atol=1e-12)


def test_a_pipe_that_is_let_go_is_not_pressed_any_more_and_moves_by_as_much_as_it_was(plant):
    posture = home_posture()
    posture[:6] = np.radians([2.9, 35.2, -7.7, 25.5, -30.3, -78.5])  # around an upright pipe
    contact, simulator, pipe = _loose(plant, posture, 18.0)
    context = simulator.get_mutable_context()
    pressed = contact.touches(_state(plant, posture))[1]  # the jaw is open there: the fixed fingers alone
    posture[6] = np.radians(40.0)
    contact.plant_state.FixValue(context, _state(plant, posture))
    simulator.AdvanceTo(0.1)
    assert contact.pipe_in(context).holder == ""
    assert not contact.sizes(context).any()
    aside = contact.pipe_in(context).pipe.point - pipe.point
    deepest = np.linalg.norm(pressed, axis=1).max() / workcell_entries()["contact"]["stiffness"]
    wedge = 0.5 * (
        0.36 + 0.4502
    )  # rad, half the angle between the fixed fingers' normals (urdf/hydrolek.urdf)
    assert deepest - 2e-4 < np.linalg.norm(aside) < deepest / np.cos(wedge) + 2e-4


def test_a_jaw_that_opens_does_not_take_a_pipe_and_one_that_closes_does(plant):
    posture, speed = home_posture(), np.zeros(14)
    posture[6] = np.radians(18.0)
    for rate, holder in ((0.1, ""), (-0.1, "right")):
        speed[6] = rate
        pipe = _pipe_in_the_gripper(posture)
        table = replace(make_table(), top=np.array([pipe.point[0], pipe.point[1], pipe.lowest()]))
        contact = GripContact(plant, pipe, table)
        simulator = Simulator(contact)
        contact.plant_state.FixValue(simulator.get_mutable_context(), _state(plant, posture, speed))
        simulator.AdvanceTo(0.05)
        assert contact.pipe_in(simulator.get_context()).holder == holder
