"""Internal force of a pipe in two grips: springs one behind the other, action and reaction, friction."""

from dataclasses import replace

import numpy as np
import pytest
from applied_forces import total_force
from pydrake.common.eigen_geometry import AngleAxis
from pydrake.math import RotationMatrix
from pydrake.systems.analysis import Simulator

from hydrolek_drake.kinematics.arms import arm_joint_names, make_arms_plant, position_indices
from hydrolek_drake.workcell.closed_chain import tools_at
from hydrolek_drake.workcell.grip_contact import GripContact
from hydrolek_drake.workcell.held_by_both import take
from hydrolek_drake.workcell.loose_pipe import GRAVITY
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.table import make_table

PIPE = make_pipe([1.8, 0.0, 0.9], [0.0, 1.0, 0.0], length=0.9)
EYE, STILL = np.eye(3), np.zeros(6)
RIGHT, LEFT = (EYE, np.array([1.6, -0.25, 0.9])), (EYE, np.array([1.6, 0.25, 0.9]))
CONTACT = workcell_entries()["contact"]


def _moved(hand, shift):
    return hand[0], hand[1] + np.asarray(shift)


def test_hands_that_keep_their_hold_feel_nothing_wherever_they_go_together():
    held = take(PIPE, (RIGHT, LEFT))
    turn = RotationMatrix(AngleAxis(0.4, [1.0, 0.0, 0.0])).matrix()
    hands = tuple((turn @ rotation, turn @ point + [0.1, 0.2, 0.3]) for rotation, point in (RIGHT, LEFT))
    force, moment, (_, point) = held.internal(hands, (STILL, STILL), 0.0)
    np.testing.assert_allclose([*force, *moment], 0.0, atol=1e-6)
    np.testing.assert_allclose(point, turn @ PIPE.point + [0.1, 0.2, 0.3], atol=1e-12)


def test_along_the_pipe_both_grips_are_springs_one_behind_the_other():
    """Each has four fingers, 4 k_t; the left hand that is drawn away pulls the pipe its way, half of it."""
    held, off = take(PIPE, (RIGHT, LEFT)), 1e-3
    force, moment, (_, point) = held.internal((RIGHT, _moved(LEFT, [0.0, off, 0.0])), (STILL, STILL), 0.0)
    np.testing.assert_allclose(force, [0.0, 2.0 * CONTACT["tangential"] * off, 0.0], atol=1e-6)
    np.testing.assert_allclose(moment, 0.0, atol=1e-6)
    np.testing.assert_allclose(point - PIPE.point, [0.0, 0.5 * off, 0.0], atol=1e-9)


def test_across_the_pipe_its_lever_on_the_tilting_grips_makes_it_soft():
    """The pipe turns about its middle, grips tilt: far softer than the contact, and even about the middle."""
    held, off = take(PIPE, (RIGHT, LEFT)), 1e-3
    force, moment, (turned, point) = held.internal(
        (RIGHT, _moved(LEFT, [0.0, 0.0, off])), (STILL, STILL), 0.0
    )
    aside = 0.035  # m, of the fixed fingers from the hand's middle (urdf/hydrolek.urdf)
    normal, tilting, arm = 2.0 * CONTACT["stiffness"], 2.0 * CONTACT["stiffness"] * aside**2, 0.25
    # by symmetry the pipe turns by theta: each grip is displaced by off/2 - arm theta and tilted by theta
    theta = normal * arm * (0.5 * off) / (normal * arm**2 + tilting)
    assert force[2] == pytest.approx(normal * (0.5 * off - arm * theta), rel=1e-6)
    assert force[2] < 0.05 * normal * off
    np.testing.assert_allclose(moment, 0.0, atol=1e-6)
    np.testing.assert_allclose(point - PIPE.point, [0.0, 0.0, 0.5 * off], atol=1e-9)
    assert np.arcsin(turned[2, 2]) == pytest.approx(theta, rel=1e-4)


def test_damping_works_against_the_speed_and_keeps_the_place():
    held, rate = take(PIPE, (RIGHT, LEFT)), np.array([0.0, 0.02, 0.0, 0.0, 0.0, 0.0])
    force, _, (_, point) = held.internal((RIGHT, LEFT), (STILL, rate), 2e-3)
    assert force[1] == pytest.approx(2.0 * CONTACT["tangential"] * 0.02 * 2e-3)
    np.testing.assert_allclose(point, PIPE.point, atol=1e-12)


def test_friction_is_used_by_what_is_along_the_axis_and_about_it():
    held, axis = take(PIPE, (RIGHT, LEFT)), PIPE.axis
    most = workcell_entries()["loose_pipe"]["friction"] * 4000.0
    assert held.friction_used(most * axis, np.zeros(3), axis, 4000.0) == pytest.approx(1.0)
    assert held.friction_used(np.zeros(3), most * PIPE.radius * axis, axis, 4000.0) == pytest.approx(1.0)
    assert held.friction_used(np.array([1e4, 0.0, 1e4]), np.zeros(3), axis, 4000.0) == 0.0
    assert held.friction_used(axis, np.zeros(3), axis, 0.0) == np.inf


def test_two_grippers_take_a_pipe_and_what_they_do_to_each_other_cancels():
    """On the plant: one hand takes it, then the other; all forces together are the pipe's weight at its middle."""
    plant = make_arms_plant()
    order = position_indices(plant, list(arm_joint_names()))
    posture = home_posture()
    posture[[6, 13]] = np.radians([18.0, 40.0])
    right, left = (poses[0] for poses in tools_at([posture]))
    middle = 0.5 * (right[:3, 3] + left[:3, 3]) - 0.0055 * right[:3, 1]  # seated in the fixed fingers
    pipe = make_pipe(middle, left[:3, 3] - right[:3, 3], length=1.5)
    under = replace(make_table(), top=np.array([middle[0], middle[1], pipe.lowest()]))
    contact = GripContact(plant, pipe, under)
    simulator = Simulator(contact)
    context = simulator.get_mutable_context()

    def stand(angles):
        state = np.zeros(plant.num_multibody_states())
        state[order] = angles
        contact.plant_state.FixValue(context, state)
        return state

    stand(posture)
    simulator.AdvanceTo(0.03)
    assert contact.pipe_in(context).holder == "right" and contact.pipe_in(context).both is None
    posture[13] = np.radians(18.0)
    stand(posture)
    simulator.AdvanceTo(0.06)
    assert contact.pipe_in(context).both is not None
    np.testing.assert_allclose(contact.internal_force.Eval(context)[:6], 0.0, atol=1e-6)

    posture[12] += np.radians(0.3)
    posture[8] += np.radians(0.1)
    state = stand(posture)
    internal = contact.internal_force.Eval(context)
    assert np.linalg.norm(internal[:3]) > 10.0
    force, moment = total_force(plant, contact.contact_force.Eval(context), state)
    weight = np.array([0.0, 0.0, -workcell_entries()["loose_pipe"]["mass"] * GRAVITY])
    np.testing.assert_allclose(force, weight, atol=1e-6)
    np.testing.assert_allclose(moment, np.cross(contact.pipe_place.Eval(context)[:3], weight), atol=1e-6)

    posture[13] = np.radians(40.0)  # the left one lets go: the right one has it alone
    stand(posture)
    simulator.AdvanceTo(0.09)
    assert contact.pipe_in(context).holder == "right" and contact.pipe_in(context).both is None
    np.testing.assert_array_equal(contact.internal_force.Eval(context), 0.0)
