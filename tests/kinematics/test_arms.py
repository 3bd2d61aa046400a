"""The plant of the arms, with all joints or some held."""

import numpy as np
import pytest
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JacobianWrtVariable, SpatialInertia, UnitInertia
from pydrake.systems.framework import DiagramBuilder
from scipy.optimize import brentq, root

import hydrolek_drake
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import (
    add_arms,
    arm_joint,
    arm_joint_names,
    arms_urdf_path,
    load_of_joint,
    make_arms_plant,
    position_indices,
)

ALL = [f"{side}_j{number}" for side in ("right", "left") for number in range(1, 8)]


@pytest.fixture(scope="module")
def full():
    return make_arms_plant()


def _posture(plant, rng):
    posture = {}
    for name in ALL:
        joint = arm_joint(plant, name)
        lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
        posture[name] = rng.uniform(lower, upper) if np.isfinite(lower) else rng.uniform(-np.pi, np.pi)
    return posture


def _context_at(plant, posture):
    context = plant.CreateDefaultContext()
    for name, angle in posture.items():
        arm_joint(plant, name).set_angle(context, angle)
    return context


def test_urdf_has_seven_joints_an_arm():
    assert arms_urdf_path().name == "hydrolek.urdf"
    assert list(arm_joint_names()) == ALL


def test_urdf_is_found_in_a_clone_and_in_an_installed_package(tmp_path, monkeypatch):
    package = tmp_path / "hydrolek_drake"
    monkeypatch.setattr(hydrolek_drake, "__file__", str(package / "__init__.py"))
    with pytest.raises(InputError, match=r"hydrolek\.urdf is in neither"):
        arms_urdf_path()
    for folder in (tmp_path / "urdf", package / "urdf"):  # the clone's place, then the wheel's, which wins
        folder.mkdir(parents=True)
        (folder / "hydrolek.urdf").touch()
        assert arms_urdf_path() == folder / "hydrolek.urdf"


@pytest.mark.parametrize("diameter", [0.030, 0.075, 0.115])
def test_gripper_holds_pipes_of_30_to_115_mm(diameter):
    """A pipe seated in the fixed jaw's V is reached by the moving jaw, and three contacts enclose it.

    In the plane across the pipe the three contact normals must point in all directions (their positive
    combinations fill the plane), so that the pipe is held without friction.
    """
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant_context = arms.plant.GetMyMutableContextFromRoot(context)
    hand, jaw = (arms.plant.GetBodyByName(f"right_{name}") for name in ("link6", "jaw"))
    palm, *fingers = arms.plant.GetCollisionGeometriesForBody(hand)
    one_side = [fingers[0], fingers[2]]  # the other two lie behind these

    def distances(centre, opening, geometries):
        arm_joint(arms.plant, "right_j7").set_angle(plant_context, opening)
        query = arms.scene_graph.get_query_output_port().Eval(arms.scene_graph.GetMyContextFromRoot(context))
        pose = arms.plant.EvalBodyPoseInWorld(plant_context, hand)
        found = {}
        for depth in (0.035, 0.0):  # the planes of a fixed finger and of the moving jaw
            for near in query.ComputeSignedDistanceToPoint(pose @ np.array([*centre, depth])):
                if near.id_G not in found or near.distance < found[near.id_G][0]:
                    found[near.id_G] = (near.distance, (pose.rotation().inverse() @ near.grad_W)[:2])
        return [found[geometry] for geometry in geometries]

    radius = diameter / 2
    seat = root(lambda centre: [d - radius for d, _ in distances(centre, 0.0, one_side)], [0.29, 0.0]).x
    limit = arm_joint(arms.plant, "right_j7").position_upper_limit()
    moving = arms.plant.GetCollisionGeometriesForBody(jaw)

    def gap(opening):
        return min(distance for distance, _ in distances(seat, opening, moving)) - radius

    assert gap(0.0) < 0.0 < gap(limit)  # closed grips it, open lets it in
    opening = brentq(gap, 0.0, limit)
    assert distances(seat, opening, [palm])[0][0] > radius
    normals = [normal for _, normal in distances(seat, opening, one_side)]
    normals.append(min(distances(seat, opening, moving), key=lambda near: near[0])[1])
    matrix = np.vstack([np.array(normals).T, np.ones(3)])
    assert np.all(np.linalg.solve(matrix, [0.0, 0.0, 1.0]) > 0.0)


def test_add_arms_gives_a_finalized_plant_with_gravity_in_the_diagram():
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=1e-3)
    diagram = builder.Build()
    assert arms.plant.is_finalized() and arms.plant.time_step() == 1e-3
    assert diagram.HasSubsystemNamed("arms") and diagram.HasSubsystemNamed("scene_graph")
    np.testing.assert_allclose(arms.plant.gravity_field().gravity_vector(), [0, 0, -9.81], atol=1e-12)
    assert arms.plant.num_positions() == len(ALL)
    assert arms.plant.geometry_source_is_registered()


def test_arm_does_not_touch_itself_within_its_range(full):
    """Contacts between links of one arm, or with the base, would stop motions that the machine makes."""
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    plant_context = arms.plant.GetMyMutableContextFromRoot(context)
    rng = np.random.default_rng(2)
    inspector = arms.scene_graph.model_inspector()
    for _ in range(200):
        for name, angle in _posture(full, rng).items():
            arm_joint(arms.plant, name).set_angle(plant_context, angle)
        query = arms.scene_graph.get_query_output_port().Eval(arms.scene_graph.GetMyContextFromRoot(context))
        for contact in query.ComputePointPairPenetration():
            bodies = {
                arms.plant.GetBodyFromFrameId(inspector.GetFrameId(geometry)).name().split("_")[0]
                for geometry in (contact.id_A, contact.id_B)
            }
            assert bodies == {"right", "left"}  # arm against arm is a true collision


@pytest.mark.parametrize("name", ALL)
def test_one_joint_plant_has_the_full_plants_inertia_and_gravity(full, name):
    rng = np.random.default_rng(3)
    posture = _posture(full, rng)
    posture[f"{name.split('_')[0]}_j4"] = -np.pi / 2  # where roll, pitch and yaw are singular
    one = make_arms_plant({other: angle for other, angle in posture.items() if other != name})
    assert one.num_positions() == 1 and one.num_velocities() == 1
    context_one = one.CreateDefaultContext()
    arm_joint(one, name).set_angle(context_one, posture[name])
    context = _context_at(full, posture)
    index = position_indices(full, [name])[0]
    np.testing.assert_allclose(
        one.CalcMassMatrix(context_one)[0, 0], full.CalcMassMatrix(context)[index, index], rtol=0, atol=1e-9
    )
    np.testing.assert_allclose(
        one.CalcGravityGeneralizedForces(context_one)[0],
        full.CalcGravityGeneralizedForces(context)[index],
        rtol=0,
        atol=1e-9,
    )


@pytest.mark.parametrize("name", ALL)
def test_rotating_load_is_the_plants_equation_of_motion(full, name):
    """J q'' + g_c cos q + g_s sin q, exact at every angle of the joint, with its payload derivative."""
    rng = np.random.default_rng(4)
    posture = _posture(full, rng)
    load = load_of_joint(name, {other: angle for other, angle in posture.items() if other != name})
    index = position_indices(full, [name])[0]
    tool = full.GetFrameByName(f"{name.split('_')[0]}_tool")
    payload = 12.5
    for angle in rng.uniform(-np.pi, np.pi, 10):
        context = _context_at(full, posture | {name: angle})
        assert full.CalcMassMatrix(context)[index, index] == pytest.approx(load.inertia, abs=1e-9)
        gravity = load.gravity_cos * np.cos(angle) + load.gravity_sin * np.sin(angle)
        assert -full.CalcGravityGeneralizedForces(context)[index] == pytest.approx(gravity, abs=1e-9)
        # a point mass at the tool: kinetic energy m |v|^2 / 2, potential energy m g z
        jacobian = full.CalcJacobianTranslationalVelocity(
            context, JacobianWrtVariable.kV, tool, np.zeros(3), full.world_frame(), full.world_frame()
        )[:, index]
        assert payload * jacobian @ jacobian == pytest.approx(payload * load.inertia_per_kg, abs=1e-9)
        lifted = load.gravity_cos_per_kg * np.cos(angle) + load.gravity_sin_per_kg * np.sin(angle)
        assert payload * 9.81 * jacobian[2] == pytest.approx(payload * lifted, abs=1e-9)


def test_payload_derivative_matches_a_welded_point_mass():
    """The same derivative from a second plant that carries the mass as a body."""
    mass, angle = 3.7, 0.35
    held = {
        "right_j1": 0.2,
        "right_j3": -0.3,
        "right_j4": 0.4,
        "right_j5": -0.5,
        "right_j6": 0.6,
        "right_j7": 0.1,
    }
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModels(str(arms_urdf_path()))
    point = SpatialInertia(mass, np.zeros(3), UnitInertia(0, 0, 0))
    body = plant.AddRigidBody("payload", plant.GetModelInstanceByName("hydrolek"), point)
    plant.WeldFrames(plant.GetFrameByName("right_tool"), body.body_frame(), RigidTransform())
    plant.Finalize()
    context = _context_at(plant, held | {"right_j2": angle})
    index = position_indices(plant, ["right_j2"])[0]
    load = load_of_joint("right_j2", held)
    assert plant.CalcMassMatrix(context)[index, index] == pytest.approx(
        load.inertia + mass * load.inertia_per_kg, abs=1e-9
    )
    expected = (load.gravity_cos + mass * load.gravity_cos_per_kg) * np.cos(angle) + (
        load.gravity_sin + mass * load.gravity_sin_per_kg
    ) * np.sin(angle)
    assert -plant.CalcGravityGeneralizedForces(context)[index] == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("side", ["right", "left"])
def test_joint_1_turns_about_the_vertical_and_feels_no_gravity(full, side):
    posture = _posture(full, np.random.default_rng(5))
    load = load_of_joint(f"{side}_j1", posture)
    assert load.inertia > 0 and load.inertia_per_kg > 0
    gravity = [load.gravity_cos, load.gravity_sin, load.gravity_cos_per_kg, load.gravity_sin_per_kg]
    np.testing.assert_allclose(gravity, 0.0, atol=1e-9)


def test_jaw_does_not_move_the_tool_frame(full):
    load = load_of_joint("right_j7", _posture(full, np.random.default_rng(6)))
    assert load.inertia > 0
    assert (load.inertia_per_kg, load.gravity_cos_per_kg, load.gravity_sin_per_kg) == (0.0, 0.0, 0.0)


def test_wrong_names_and_angles_are_refused_with_the_choices(full):
    with pytest.raises(InputError, match=r"'right_j8'.*right_j1"):
        make_arms_plant({"right_j8": 0.0})
    with pytest.raises(InputError, match=r"right_j2.*nan"):
        make_arms_plant({"right_j2": float("nan")})
    with pytest.raises(InputError, match=r"'elbow'.*right_j3"):
        load_of_joint("elbow", {})
    with pytest.raises(InputError, match=r"right_j3, right_j4.*missing"):
        load_of_joint("right_j2", {"right_j1": 0.0})
    with pytest.raises(InputError, match=r"'plate'.*left_j7"):
        position_indices(full, ["plate"])
    with pytest.raises(InputError, match="right_j2"):
        position_indices(make_arms_plant({"right_j1": 0.1}), ["right_j1"])
    with pytest.raises(InputError, match=r"-0\.1"):
        add_arms(DiagramBuilder(), time_step=-0.1)
