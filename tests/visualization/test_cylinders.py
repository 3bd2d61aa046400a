"""Barrels and rods follow their mounts."""

import numpy as np
import pytest
from pydrake.geometry import Role
from pydrake.systems.framework import DiagramBuilder

from hydrolek_drake.kinematics.arms import add_arms, arm_joint
from hydrolek_drake.kinematics.cylinder_linkage import cylinder_linkages
from hydrolek_drake.visualization.cylinders import add_cylinders, arm_cylinder_mounts


@pytest.fixture(scope="module")
def scene():
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0)
    mounts = arm_cylinder_mounts()
    cylinders = add_cylinders(builder, arms.plant, arms.scene_graph, mounts)
    return builder.Build(), arms, cylinders, mounts


def _frame(arms, name):
    inspector = arms.scene_graph.model_inspector()
    return next(frame for frame in inspector.GetAllFrameIds() if inspector.GetName(frame) == name)


def _at_random_angles(scene, seed, count):
    diagram, arms, _, _ = scene
    context = diagram.CreateDefaultContext()
    plant_context = arms.plant.GetMyMutableContextFromRoot(context)
    rng = np.random.default_rng(seed)
    for _ in range(count):
        angles = {}
        for index in arms.plant.GetJointIndices():
            joint = arms.plant.get_joint(index)
            if joint.num_positions() == 1:
                lower, upper = joint.position_lower_limit(), joint.position_upper_limit()
                angles[joint.name()] = rng.uniform(lower, upper) if np.isfinite(lower) else rng.uniform(-3, 3)
                arm_joint(arms.plant, joint.name()).set_angle(plant_context, angles[joint.name()])
        yield context, plant_context, angles


def test_mounts_are_the_ten_linear_cylinders():
    assert sorted(mount.name for mount in arm_cylinder_mounts()) == sorted(
        f"{side}_j{number}" for side in ("right", "left") for number in (1, 2, 3, 5, 7)
    )


def test_barrel_and_rod_lie_on_the_line_between_the_mounts(scene):
    _, arms, cylinders, mounts = scene
    for context, plant_context, angles in _at_random_angles(scene, 21, 10):
        poses = cylinders.geometry_pose.Eval(cylinders.GetMyContextFromRoot(context))
        query = arms.scene_graph.get_query_output_port().Eval(arms.scene_graph.GetMyContextFromRoot(context))
        for mount in mounts:
            parent, child = (
                arms.plant.EvalBodyPoseInWorld(plant_context, arms.plant.GetBodyByName(body))
                @ np.array(point)
                for body, point in ((mount.parent_body, mount.p_parent), (mount.child_body, mount.p_child))
            )
            length = np.linalg.norm(child - parent)
            barrel = poses.value(_frame(arms, f"{mount.name}_barrel"))
            rod = poses.value(_frame(arms, f"{mount.name}_rod"))
            np.testing.assert_allclose(barrel.translation(), parent, rtol=0, atol=1e-12)
            np.testing.assert_allclose(barrel @ np.array([0, 0, length]), child, rtol=0, atol=1e-12)
            np.testing.assert_allclose(rod.translation(), child, rtol=0, atol=1e-12)
            np.testing.assert_allclose(rod @ np.array([0, 0, length]), parent, rtol=0, atol=1e-12)
            # the plant's kinematics give the length that the triangle's equation gives
            expected = cylinder_linkages()[mount.name].length(angles[mount.name])
            assert length == pytest.approx(float(expected), abs=1e-12)
            assert length >= mount.closed_length - 1e-12
            # and the scene graph draws it there
            drawn = query.GetPoseInWorld(_frame(arms, f"{mount.name}_rod"))
            assert drawn.IsNearlyEqualTo(rod, 1e-12)


def test_mirrored_angles_give_mirrored_cylinders(scene):
    diagram, arms, cylinders, mounts = scene
    context = diagram.CreateDefaultContext()
    plant_context = arms.plant.GetMyMutableContextFromRoot(context)
    angles = np.random.default_rng(22).uniform(0.05, 0.35, 7)
    for number, (angle, sign) in enumerate(zip(angles, [-1, 1, 1, -1, 1, -1, 1], strict=True), start=1):
        arm_joint(arms.plant, f"right_j{number}").set_angle(plant_context, angle)
        arm_joint(arms.plant, f"left_j{number}").set_angle(plant_context, sign * angle)
    poses = cylinders.geometry_pose.Eval(cylinders.GetMyContextFromRoot(context))
    for mount in mounts:
        if mount.name.startswith("right"):
            other = mount.name.replace("right", "left")
            for part in ("barrel", "rod"):
                right = poses.value(_frame(arms, f"{mount.name}_{part}"))
                left = poses.value(_frame(arms, f"{other}_{part}"))
                for on_axis in (np.zeros(3), np.array([0.0, 0.0, 0.1])):
                    np.testing.assert_allclose(
                        left @ on_axis, (right @ on_axis) * [1, -1, 1], rtol=0, atol=1e-12
                    )


def test_rod_stays_in_the_barrel_over_the_whole_stroke(scene):
    """At full extension the rod's end is still inside the tube; retracted, it does not stick out behind."""
    _, arms, _, mounts = scene
    inspector = arms.scene_graph.model_inspector()
    for mount in mounts:
        joint = arm_joint(arms.plant, mount.name)
        linkage = cylinder_linkages()[mount.name]
        longest = max(
            float(linkage.length(joint.position_lower_limit())),
            float(linkage.length(joint.position_upper_limit())),
        )
        ends = {}
        for part in ("barrel", "rod"):
            frame = _frame(arms, f"{mount.name}_{part}")
            for geometry in inspector.GetGeometries(frame, Role.kIllustration):
                shape = inspector.GetShape(geometry)
                if hasattr(shape, "length"):
                    centre = inspector.GetPoseInFrame(geometry).translation()[2]
                    ends[part] = max(ends.get(part, 0.0), centre + shape.length() / 2)
        assert longest - ends["rod"] < ends["barrel"]
        assert ends["rod"] < mount.closed_length


def test_cylinders_are_seen_by_cameras_but_touch_nothing(scene):
    _, arms, cylinders, mounts = scene
    inspector = arms.scene_graph.model_inspector()
    for mount in mounts:
        for part in ("barrel", "rod"):
            frame = _frame(arms, f"{mount.name}_{part}")
            assert inspector.BelongsToSource(frame, cylinders.source_id)
            seen = inspector.GetGeometries(frame, Role.kPerception)
            assert len(seen) == len(inspector.GetGeometries(frame, Role.kIllustration)) > 0
            assert not inspector.GetGeometries(frame, Role.kProximity)


def test_poses_depend_on_the_body_poses_directly(scene):
    _, _, cylinders, _ = scene
    assert cylinders.HasDirectFeedthrough(
        cylinders.body_poses.get_index(), cylinders.geometry_pose.get_index()
    )
    assert cylinders.get_name() == "cylinder_poses"


def test_cylinders_follow_a_plant_with_held_joints():
    """Mounts belong to bodies, so the same list serves a plant in which joints have become welds."""
    held = {"right_j3": -0.4}
    builder = DiagramBuilder()
    arms = add_arms(builder, time_step=0.0, held=held)
    mounts = arm_cylinder_mounts()
    cylinders = add_cylinders(builder, arms.plant, arms.scene_graph, mounts)
    diagram = builder.Build()
    context = diagram.CreateDefaultContext()
    poses = cylinders.geometry_pose.Eval(cylinders.GetMyContextFromRoot(context))
    barrel, rod = (poses.value(_frame(arms, f"right_j3_{part}")).translation() for part in ("barrel", "rod"))
    assert np.linalg.norm(rod - barrel) == pytest.approx(
        float(cylinder_linkages()["right_j3"].length(-0.4)), abs=1e-12
    )
