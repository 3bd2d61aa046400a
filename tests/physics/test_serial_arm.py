"""The compiled equation of motion of turning links, held against the Diagram's MultibodyPlant and closed forms."""

import numpy as np
import pytest
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces, SpatialInertia, UnitInertia, default_model_instance
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import (
    add_arms,
    arm_joint,
    arm_joint_names,
    load_of_joint,
    make_arms_plant,
)
from hydrolek_drake.kinematics.rigid_links import rigid_links
from hydrolek_drake.physics.bodies.mass_matrix import PARENT, ROOT, accelerations
from hydrolek_drake.physics.bodies.serial_arm import LINK_SIZE, moments_along

BOTH = arm_joint_names()
SOME = ("right_j2", "right_j3", "right_j5", "left_j1", "left_j4")
ROUNDING = 1e-10  # N m, of moments of some 1e2 N m


def _moments(plant: MultibodyPlant, joints, q, w, a) -> np.ndarray:
    """What the plant's inverse dynamics ask of the joints."""
    places = [arm_joint(plant, joint).velocity_start() for joint in joints]
    context = plant.CreateDefaultContext()
    whole = np.zeros((3, plant.num_velocities()))
    whole[:, places] = q, w, a
    plant.SetPositions(context, whole[0])
    plant.SetVelocities(context, whole[1])
    forces = MultibodyForces(plant)
    plant.CalcForceElementsContribution(context, forces)
    return plant.CalcInverseDynamics(context, whole[2], forces)[places]


@pytest.mark.parametrize("joints", [BOTH, SOME], ids=["all", "some"])
def test_moments_are_those_of_the_multibody_plant(joints) -> None:
    rng = np.random.default_rng(7)
    held = {joint: float(rng.uniform(-1.0, 1.0)) for joint in BOTH if joint not in joints}
    q, w, a = rng.uniform(-1.5, 1.5, (3, 5, len(joints)))
    told = moments_along(rigid_links(joints, held), q, w, a)
    plant = make_arms_plant(held)
    wanted = [_moments(plant, joints, *moved) for moved in zip(q, w, a, strict=True)]
    assert told == pytest.approx(np.array(wanted), abs=ROUNDING)


def test_a_payload_weighs_as_a_body_at_the_tool() -> None:
    rng = np.random.default_rng(8)
    mass = 17.0

    def hang(made: MultibodyPlant) -> None:
        point = SpatialInertia(mass, np.zeros(3), UnitInertia(0.0, 0.0, 0.0))
        body = made.AddRigidBody("payload", default_model_instance(), point)
        made.WeldFrames(made.GetFrameByName("left_tool"), body.body_frame())

    plant = add_arms(DiagramBuilder(), time_step=0.0, before_finalize=hang).plant
    q, w, a = rng.uniform(-1.5, 1.5, (3, len(BOTH)))
    hanging = np.array([mass if joint.startswith("left") else 0.0 for joint in BOTH])
    told = moments_along(rigid_links(BOTH, {}), q[None], w[None], a[None], hanging[None])[0]
    assert told == pytest.approx(_moments(plant, BOTH, q, w, a), abs=ROUNDING)


@pytest.mark.parametrize("joint", ["right_j2", "left_j5"])
def test_one_joint_alone_is_a_body_that_turns(joint) -> None:
    held = {name: 0.1 * n for n, name in enumerate(BOTH) if name != joint}
    load = load_of_joint(joint, held)
    q, w, a = 0.7, 1.3, -2.0
    moments = moments_along(rigid_links([joint], held), *(np.array([[value]]) for value in (q, w, a)))
    carried = load.gravity_cos * np.cos(q) + load.gravity_sin * np.sin(q)
    assert moments[0, 0] == pytest.approx(load.inertia * a + carried, abs=ROUNDING)


def test_accelerations_solve_the_equation_of_motion() -> None:
    rng = np.random.default_rng(9)
    links = np.zeros((6, LINK_SIZE))
    links[:, PARENT] = [ROOT, ROOT, 0, 1, 3, 3]  # a fork, and links of two arms one after the other
    between = [(2, 0), (3, 1), (4, 3), (4, 1), (5, 3), (5, 1)]
    matrix, torque = 5.0 * np.eye(6), rng.normal(size=6)
    for i, j in between:
        matrix[i, j] = matrix[j, i] = rng.normal()
    found = torque.copy()
    accelerations(links, matrix.copy(), found)
    assert matrix @ found == pytest.approx(torque)


def test_a_joint_that_the_arms_do_not_have_is_refused() -> None:
    with pytest.raises(InputError, match="right_j9"):
        rigid_links(["right_j9"], {})
