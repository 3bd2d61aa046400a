"""The compiled arm against Drake's MultibodyPlant, and its integrator against a finer one."""

import numpy as np
import pytest

from hydrolek_drake.identification.mechanical.arm_bodies import JOINTS, arm_bodies
from hydrolek_drake.identification.mechanical.arm_dynamics import simulate_joints
from hydrolek_drake.kinematics.arms import arm_joint, make_arms_plant
from hydrolek_drake.physics.bodies.serial_arm import moments_along, motion_equation, scratch

GRAVITY = 9.81


@pytest.fixture(scope="module")
def right_arm():
    plant = make_arms_plant({"right_j7": 0.0})
    indices = [arm_joint(plant, f"right_j{k}").velocity_start() for k in range(1, JOINTS + 1)]
    masses = np.array([plant.GetBodyByName(f"right_link{k}").default_mass() for k in range(1, JOINTS + 1)])
    return plant, indices, masses


@pytest.mark.parametrize("seed", range(3))
def test_mass_matrix_and_bias_are_those_of_the_plant(right_arm, seed):
    plant, indices, masses = right_arm
    rng = np.random.default_rng(seed)
    q, v = rng.uniform(-2.0, 2.0, JOINTS), rng.uniform(-3.0, 3.0, JOINTS)
    context = plant.CreateDefaultContext()
    positions, velocities = np.zeros(plant.num_positions()), np.zeros(plant.num_velocities())
    positions[indices], velocities[indices] = q, v
    plant.SetPositions(context, positions)
    plant.SetVelocities(context, velocities)
    expected = plant.CalcMassMatrix(context)[np.ix_(indices, indices)]
    # the other arm stands still, so it adds nothing to the bias of this one
    torque = (plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context))[indices]
    matrix, bias = np.empty((JOINTS, JOINTS)), np.empty(JOINTS)
    links = arm_bodies().with_masses(masses, GRAVITY)
    motion_equation(links, np.sin(q), np.cos(q), v, np.zeros(JOINTS), scratch(JOINTS), matrix, bias)
    np.testing.assert_allclose(matrix, expected, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(bias, torque, rtol=1e-6, atol=1e-6 * np.abs(torque).max())


def _swing(step, duration=2.0):
    masses = np.array([4.6, 5.1, 22.5, 1.6, 4.1, 4.7])
    count = round(duration / step)
    command = np.tile([10.0, 150.0, 60.0, 5.0, 20.0, 1.0], (count, 1))
    angles = simulate_joints(command, step, 1.0, 231.8, 53.4, arm_bodies().with_masses(masses, GRAVITY))
    return angles[:: round(0.1 / step)]


def test_simulation_converges_with_first_order():
    reference = _swing(0.0005)
    errors = [np.abs(_swing(step) - reference).max() for step in (0.02, 0.01)]
    assert 1.7 < errors[0] / errors[1] < 2.4
    assert np.degrees(errors[0]) < 0.5


def test_arm_comes_to_rest_where_springs_gain_and_gravity_balance():
    masses = np.array([4.6, 5.1, 22.5, 1.6, 4.1, 4.7])
    push = np.array([5.0, 150.0, 60.0, 5.0, 20.0, 1.0])
    links = arm_bodies().with_masses(masses, GRAVITY)
    last = simulate_joints(np.tile(push, (8000, 1)), 0.02, 1.0, 231.8, 53.4, links)[-1]
    still = np.zeros((1, JOINTS))
    held = moments_along(links, last[None], still, still)[0]
    np.testing.assert_allclose(held + 53.4 * last, push, atol=1e-3)
