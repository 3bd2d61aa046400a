"""Inverse kinematics: finds what exists, within the limits, and says why where nothing does."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import arm_chain, joint_limits
from hydrolek_drake.kinematics.forward import tool_pose, wrist_position
from hydrolek_drake.kinematics.inverse import inverse_pose, inverse_position
from hydrolek_drake.kinematics.obstacles import Obstacle

SIDES = ["right", "left"]
MIRROR = np.array([-1.0, 1.0, 1.0, -1.0, 1.0, -1.0])


def _postures(side, count, seed):
    lower, upper = (limits[:6].copy() for limits in joint_limits(side))
    lower[5], upper[5] = -np.pi, np.pi
    return np.random.default_rng(seed).uniform(lower, upper, (count, 6))


def _within(angles, side):
    lower, upper = joint_limits(side)
    return np.all(angles >= lower[:6]) and np.all(angles <= upper[:6])


@pytest.mark.parametrize("side", SIDES)
def test_every_random_point_is_reached_within_the_limits(side):
    for pose in tool_pose(_postures(side, 1000, 1)):
        angles = inverse_position(pose[:3, 3], side, explain=False).nearest()
        assert _within(angles, side)
        np.testing.assert_allclose(tool_pose(angles)[:3, 3], pose[:3, 3], rtol=0, atol=1e-9)


@pytest.mark.parametrize("side", SIDES)
def test_every_random_pose_is_reached_and_its_own_posture_is_among_the_branches(side):
    for posture, pose in zip(_postures(side, 1000, 2), tool_pose(_postures(side, 1000, 2)), strict=True):
        result = inverse_pose(pose[:3, 3], pose[:3, 0], side, jaw_axis=pose[:3, 2], near=posture)
        np.testing.assert_allclose(result.nearest(), posture, rtol=0, atol=1e-6)
        for angles in result.angles:
            assert _within(angles, side)
            reached = tool_pose(angles)
            np.testing.assert_allclose(reached[:3, 3], pose[:3, 3], rtol=0, atol=2e-6)
            np.testing.assert_allclose(reached[:3, 0], pose[:3, 0], rtol=0, atol=2e-6)
            assert abs(reached[:3, 2] @ pose[:3, 2]) == pytest.approx(1.0, abs=1e-9)


def test_corners_of_the_joint_space_are_reached():
    """All joints at an end of their travel, where a rounding error would put them outside."""
    lower, upper = joint_limits("right")
    for corner in np.ndindex(2, 2, 2, 2, 2):
        posture = np.append(np.where(np.array(corner) == 0, lower[:5], upper[:5]), 0.0)
        pose = tool_pose(posture)
        np.testing.assert_allclose(
            inverse_pose(pose[:3, 3], pose[:3, 0], near=posture).nearest(), posture, rtol=0, atol=1e-4
        )
        angles = inverse_position(pose[:3, 3], near=posture).nearest()
        np.testing.assert_allclose(tool_pose(angles)[:3, 3], pose[:3, 3], rtol=0, atol=1e-6)


@pytest.mark.parametrize("joint_4_deg", [-90.0, 0.0, -114.0, 1e-7])
def test_singular_postures_of_joint_4_are_reached(joint_4_deg):
    """At 0 the arm is planar and joint 5 leaves no trace in joint 1; at -90 both branches of joint 4 meet."""
    for posture in _postures("right", 100, 3):
        posture[3] = np.radians(joint_4_deg)
        pose = tool_pose(posture)
        result = inverse_pose(pose[:3, 3], pose[:3, 0], near=posture)
        np.testing.assert_allclose(tool_pose(result.nearest())[:3, 3], pose[:3, 3], rtol=0, atol=1e-5)
        np.testing.assert_allclose(result.nearest(), posture, rtol=0, atol=1e-3)


def test_poses_with_three_postures_are_given_all_three():
    """Folds of the closed form near joint 5 = -81 deg; each of the three is found from each."""
    posture = np.radians([-0.1000, 3.5987, 19.0391, -108.1660, -81.0591, 0.0])
    pose = tool_pose(posture)
    result = inverse_pose(pose[:3, 3], pose[:3, 0], near=posture)
    assert len(result.angles) == 3
    np.testing.assert_allclose(result.nearest(), posture, rtol=0, atol=1e-6)
    for angles in result.angles:
        np.testing.assert_allclose(tool_pose(angles)[:3, [0, 3]], pose[:3, [0, 3]], rtol=0, atol=1e-6)
        other = inverse_pose(pose[:3, 3], pose[:3, 0], near=angles)
        np.testing.assert_allclose(other.nearest(), angles, rtol=0, atol=1e-6)


def test_wrist_point_is_the_thesis_s():
    posture = _postures("right", 1, 4)[0]
    angles = inverse_position(wrist_position(posture), point="wrist").nearest()
    np.testing.assert_allclose(wrist_position(angles), wrist_position(posture), rtol=0, atol=1e-9)


def test_left_arm_is_the_mirror_image():
    for posture in _postures("right", 20, 5):
        posture[3] *= (
            63.0 / 114.0
        )  # joint 4 has the same limits on both arms, so its range is no mirror image
        pose = tool_pose(posture)
        flip = np.array([1.0, 1.0, -1.0])
        right = inverse_pose(pose[:3, 3], pose[:3, 0], "right").nearest()
        left = inverse_pose(pose[:3, 3] * flip, pose[:3, 0] * flip, "left").nearest()
        np.testing.assert_allclose(left, MIRROR * right, rtol=0, atol=1e-7)


def test_nearest_posture_to_the_wanted_one_is_taken():
    """Of all postures of a point; the wanted one reaches it itself, to the search's last step of 0.3 deg."""
    for posture in _postures("right", 50, 8):
        angles = inverse_position(tool_pose(posture)[:3, 3], near=posture).nearest()
        middle = inverse_position(tool_pose(posture)[:3, 3]).nearest()
        assert np.linalg.norm(angles - posture) <= np.linalg.norm(middle - posture) + np.radians(0.6)


def test_a_point_beyond_the_arm_is_out_of_reach():
    result = inverse_position([2.0, 0.0, 0.0])
    assert result.obstacle is Obstacle.POSITION and not result.reached
    # Table 5.1 and the 0.295 m to the grasp point give the links' span from joint 2
    assert "1.930 m from joint 2" in result.reason
    with pytest.raises(InputError, match="joint 2"):
        result.nearest()


@pytest.mark.parametrize(("joint", "excess_deg"), [(1, 8.0), (2, 5.0), (3, 10.0), (4, 6.0)])
def test_a_posture_beyond_one_stroke_is_refused_for_the_stroke(joint, excess_deg):
    """The pose of a posture with one joint just outside; it must be unreachable inside to count."""
    posture = arm_chain("right").middle.copy()
    posture[joint - 1] = joint_limits("right")[1][joint - 1] + np.radians(excess_deg)
    pose = tool_pose(posture)
    result = inverse_pose(pose[:3, 3], pose[:3, 0])
    assert result.obstacle is Obstacle.STROKE_LIMITS
    assert f"joint {joint} would have to turn" in result.reason
    assert "stroke ends at" in result.reason


def test_every_point_of_a_cube_is_reached_or_refused_with_a_reason_that_holds():
    """In and out of reach, and along its border, where a search might creep for ever."""
    seen = set()
    for point in np.random.default_rng(12).uniform([-0.2, -1.2, -1.2], [1.6, 1.2, 1.2], (300, 3)):
        result = inverse_position(point)
        seen.add(result.obstacle)
        if result.reached:
            np.testing.assert_allclose(tool_pose(result.nearest())[:3, 3], point, rtol=0, atol=1e-5)
        else:
            assert result.reason
    assert seen == {None, Obstacle.POSITION, Obstacle.STROKE_LIMITS}


def test_a_direction_back_at_the_operator_is_refused_for_the_direction():
    result = inverse_pose([0.9, 0.3, 0.1], [-1.0, 0.0, 0.0])
    assert result.obstacle is Obstacle.ORIENTATION
    assert "nearest direction" in result.reason


def test_the_nearest_direction_that_is_offered_can_be_had_and_no_sample_is_nearer():
    target, aim = np.array([0.9, 0.3, 0.1]), np.array([1.0, 0.0, 0.0])
    reason = inverse_pose(target, aim).reason
    offered = np.array([float(word) for word in reason.split("there is (")[1].split(")")[0].split(",")])
    assert inverse_pose(target, offered, near=arm_chain("right").middle).reached or (
        inverse_pose(target, offered + 1e-3 * (tool_pose(np.zeros(6))[:3, 0] - offered)).reached
    )
    rng = np.random.default_rng(9)
    for sample in rng.normal(size=(3000, 3)):
        sample /= np.linalg.norm(sample)
        if sample @ aim > offered @ aim + 2e-3:
            assert not inverse_pose(target, sample, explain=False).reached


@pytest.mark.parametrize(
    ("arguments", "named", "message"),
    [
        (([1.0, 2.0], "right"), {}, "three finite numbers"),
        (([1.0, np.nan, 0.0], "right"), {}, "three finite numbers"),
        (([1.0, 0.0, 0.0], "middle"), {}, "choose from right, left"),
        (([1.0, 0.0, 0.0], "right"), {"point": "elbow"}, "choose from tool, wrist"),
        (([1.0, 0.0, 0.0], "right"), {"near": [0.0]}, "six finite joint angles"),
    ],
)
def test_bad_input_is_refused(arguments, named, message):
    with pytest.raises(InputError, match=message):
        inverse_position(*arguments, **named)


def test_a_direction_without_length_and_a_parallel_jaw_axis_are_refused():
    with pytest.raises(InputError, match="no direction"):
        inverse_pose([0.9, 0.0, 0.0], [0.0, 0.0, 0.0])
    pose = tool_pose(_postures("right", 1, 10)[0])
    with pytest.raises(InputError, match="parallel"):
        inverse_pose(pose[:3, 3], pose[:3, 0], jaw_axis=pose[:3, 0])
