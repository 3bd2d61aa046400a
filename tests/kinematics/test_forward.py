"""Equation (5.3), the URDF and the thesis's tables agree."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.arms import arm_joint, make_arms_plant, position_indices
from hydrolek_drake.kinematics.forward import arm_geometry, joint_positions, tool_pose, wrist_position

# Table 3.2, degrees; joint 1 is mirrored, the others are equal
LIMITS_DEG = {
    "right": [(-27.0, 40.6), (-10.3, 65.6), (-42.0, 21.4), (-114.0, 63.9), (-81.5, -4.16)],
    "left": [(-40.6, 27.0), (-10.3, 65.6), (-42.0, 21.4), (-114.0, 63.9), (-81.5, -4.16)],
}
TABLE_5_2_AXES = {1: [0, 1, 0], 2: [0, 0, 1], 3: [0, 0, 1], 4: [0, 1, 0], 5: [0, 0, 1], 6: [1, 0, 0]}
TABLE_4_8_MASSES = [2.97, 4.99, 16.08, 5.78, 7.12, 6.99]
MIRROR_SIGNS = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0, 1.0])


@pytest.fixture(scope="module")
def plant():
    return make_arms_plant()


def _names(side):
    return [f"{side}_j{number}" for number in range(1, 8)]


@pytest.mark.parametrize("side", ["right", "left"])
def test_plant_and_equation_5_3_have_the_same_wrist_and_tool(plant, side):
    rng = np.random.default_rng(53)
    samples = rng.uniform(-np.pi, np.pi, (1000, 6))
    context = plant.CreateDefaultContext()
    base = plant.GetFrameByName(f"{side}_base")
    wrist = plant.GetJointByName(f"{side}_j6").frame_on_child()
    tool = plant.GetFrameByName(f"{side}_tool")
    joints = [arm_joint(plant, name) for name in _names(side)[:6]]
    wrists, tools = np.empty((1000, 3)), np.empty((1000, 4, 4))
    for index, angles in enumerate(samples):
        for joint, angle in zip(joints, angles, strict=True):
            joint.set_angle(context, angle)
        wrists[index] = wrist.CalcPose(context, base).translation()
        tools[index] = tool.CalcPose(context, base).GetAsMatrix4()
    np.testing.assert_allclose(wrist_position(samples), wrists, rtol=0, atol=1e-9)
    np.testing.assert_allclose(tool_pose(samples), tools, rtol=0, atol=1e-9)


def test_zero_posture_is_the_sum_of_table_5_1():
    np.testing.assert_allclose(wrist_position(np.zeros(6)), [1.08773, -0.23107, 0.0], rtol=0, atol=1e-12)


def test_turning_joint_1_by_90_degrees_sends_the_arm_along_minus_z():
    np.testing.assert_allclose(
        wrist_position([np.pi / 2, 0, 0, 0, 0, 0]), [0.0, -0.23107, -1.08773], rtol=0, atol=1e-12
    )


def test_raising_joint_2_by_90_degrees_sends_the_arm_up():
    # beyond the shoulder's 0.07 m, x becomes y and y becomes -x
    np.testing.assert_allclose(
        wrist_position([0, np.pi / 2, 0, 0, 0, 0]), [0.07 + 0.23107, 1.01773, 0.0], rtol=0, atol=1e-12
    )


def test_joint_6_moves_neither_wrist_nor_grasp_point():
    angles = np.array([0.2, 0.3, -0.4, 0.5, -0.6, 0.0])
    turned = angles + np.eye(6)[5] * 1.1
    np.testing.assert_array_equal(wrist_position(angles), wrist_position(turned))
    np.testing.assert_allclose(tool_pose(angles)[:3, 3], tool_pose(turned)[:3, 3], rtol=0, atol=1e-15)
    assert not np.allclose(tool_pose(angles)[:3, :3], tool_pose(turned)[:3, :3])


def test_any_leading_shape_is_accepted_and_a_wrong_last_one_refused():
    assert wrist_position(np.zeros((2, 3, 6))).shape == (2, 3, 3)
    assert tool_pose(np.zeros((2, 3, 6))).shape == (2, 3, 4, 4)
    with pytest.raises(InputError, match=r"\(2, 7\)"):
        wrist_position(np.zeros((2, 7)))


@pytest.mark.parametrize("side", ["right", "left"])
def test_joint_axes_are_those_of_table_5_2(plant, side):
    context = plant.CreateDefaultContext()
    base = plant.GetFrameByName(f"{side}_base")
    for number, axis in TABLE_5_2_AXES.items():
        joint = arm_joint(plant, f"{side}_j{number}")
        in_base = joint.frame_on_parent().CalcPose(context, base).rotation() @ joint.revolute_axis()
        np.testing.assert_allclose(in_base, axis, rtol=0, atol=1e-12)


@pytest.mark.parametrize("side", ["right", "left"])
def test_limits_are_those_of_table_3_2(plant, side):
    for name, (lower, upper) in zip(_names(side), LIMITS_DEG[side], strict=False):
        joint = arm_joint(plant, name)
        np.testing.assert_allclose(
            np.degrees([joint.position_lower_limit(), joint.position_upper_limit()]),
            [lower, upper],
            rtol=1e-12,
        )
    endless = arm_joint(plant, f"{side}_j6")
    assert np.isneginf(endless.position_lower_limit()) and np.isposinf(endless.position_upper_limit())


@pytest.mark.parametrize("side", ["right", "left"])
def test_one_arm_weighs_45_kg_shared_as_in_table_4_8(plant, side):
    def mass(body):
        return plant.GetBodyByName(f"{side}_{body}").default_mass()

    masses = [mass(f"link{number}") for number in range(1, 6)] + [mass("link6") + mass("jaw")]
    assert sum(masses) == pytest.approx(45.0, abs=1e-6)
    expected = np.array(TABLE_4_8_MASSES) * 45.0 / sum(TABLE_4_8_MASSES)
    np.testing.assert_allclose(masses, expected, rtol=1e-9)


@pytest.mark.parametrize("side", ["right", "left"])
def test_arm_is_1_5_m_long_from_base_to_jaw_tips(side):
    """Thesis 3.1; from the drawn shapes of the fixed jaw at zero angles, to 5 mm."""
    robot = _urdf_script().ElementTree.parse(_urdf_script().URDF).getroot()
    hand = next(link for link in robot.iter("link") if link.get("name") == f"{side}_link6")
    reach = 0.0
    for visual in hand.iter("visual"):
        box = visual.find("geometry/box")
        if box is not None:
            x = float(visual.find("origin").get("xyz").split()[0])
            pitch = float(visual.find("origin").get("rpy", "0 0 0").split()[2])
            length, thickness, _ = (float(word) for word in box.get("size").split())
            reach = max(reach, x + (length * np.cos(pitch) + thickness * abs(np.sin(pitch))) / 2)
    assert wrist_position(np.zeros(6))[0] + reach == pytest.approx(1.5, abs=0.005)


def test_mirrored_angles_give_mirror_images(plant):
    """Positions, gravity torques and mass matrix; the mirror plane is y = 0 of the world."""
    rng = np.random.default_rng(11)
    context = plant.CreateDefaultContext()
    right, left = (position_indices(plant, _names(side)) for side in ("right", "left"))
    links = ["link1", "link2", "link3", "link4", "link5", "link6", "jaw", "tool"]
    for _ in range(20):
        angles = rng.uniform(-1.5, 1.5, 7)
        positions = np.empty(14)
        positions[right], positions[left] = angles, MIRROR_SIGNS * angles
        plant.SetPositions(context, positions)
        for link in links:
            on_right, on_left = (
                plant.EvalBodyPoseInWorld(context, plant.GetBodyByName(f"{side}_{link}")).translation()
                for side in ("right", "left")
            )
            np.testing.assert_allclose(on_left, on_right * [1, -1, 1], rtol=0, atol=1e-12)
        torque = plant.CalcGravityGeneralizedForces(context)
        np.testing.assert_allclose(torque[left], MIRROR_SIGNS * torque[right], rtol=0, atol=1e-9)
        mass = plant.CalcMassMatrix(context)
        pattern = np.outer(MIRROR_SIGNS, MIRROR_SIGNS)
        np.testing.assert_allclose(
            mass[np.ix_(left, left)], pattern * mass[np.ix_(right, right)], rtol=0, atol=1e-9
        )
        np.testing.assert_array_equal(mass[np.ix_(left, right)], 0.0)


def test_urdf_inertias_and_left_arm_are_up_to_date():
    script = _urdf_script()
    text = script.URDF.read_text()
    assert script.refresh(text) == text


def _urdf_script():
    path = Path(__file__).resolve().parents[2] / "scripts" / "refresh_urdf.py"
    specification = importlib.util.spec_from_file_location("refresh_urdf", path)
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_the_joints_of_an_arm_are_the_links_apart_and_end_at_the_wrist_and_the_tool():
    angles = np.array([0.2, 0.5, -0.3, 0.4, -0.6, 0.7])
    points = joint_positions(angles)
    assert points.shape == (8, 3)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    wanted = np.linalg.norm([*arm_geometry().link_vectors[1:], arm_geometry().tool_vector], axis=1)
    np.testing.assert_allclose(lengths, wanted, atol=1e-12)
    np.testing.assert_allclose(points[6], wrist_position(angles), atol=1e-12)
    np.testing.assert_allclose(points[7], tool_pose(angles)[:3, 3], atol=1e-12)
