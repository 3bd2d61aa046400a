"""Both hands on one rigid object: joints by closed form, checked by forward kinematics and by geometry."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.frames import fixed_pose
from hydrolek_drake.workcell.closed_chain import chain_error, follow, hold_at, object_path, tools_at
from hydrolek_drake.workcell.scene import home_posture

POSE = np.eye(4)
POSE[:3, 3] = [1.85, 0.0, 0.75]


@pytest.fixture(scope="module")
def posture():
    """Both arms a little off their first posture, with room to all sides."""
    changed = home_posture()
    changed[[1, 8]] += np.radians(12.0)
    return changed


@pytest.mark.parametrize(
    ("shift", "axis", "angle_deg"),
    [
        ((0.0, 0.0, 0.05), (0, 0, 1), 0.0),
        ((0.0, 0.04, 0.0), (0, 0, 1), 6.0),
        ((0.02, 0.0, 0.0), (1, 0.3, 0), -5.0),
    ],
)
def test_both_tools_stay_where_they_hold_the_object(posture, shift, axis, angle_deg):
    hold = hold_at(posture, POSE)
    path = object_path(POSE, shift, axis, np.radians(angle_deg), 0.01)
    np.testing.assert_allclose(path[-1, :3, 3] - POSE[:3, 3], shift, atol=1e-12)
    assert np.arccos(0.5 * (np.trace(path[-1, :3, :3]) - 1.0)) == pytest.approx(
        np.radians(abs(angle_deg)), abs=1e-7
    )
    postures = follow(path, hold, posture)
    right, left = tools_at(postures)
    np.testing.assert_allclose(right, path @ hold.right, atol=1e-6)
    np.testing.assert_allclose(left, path @ hold.left, atol=1e-6)
    np.testing.assert_allclose(postures[0], posture, atol=1e-6)
    assert np.max(np.abs(np.diff(postures, axis=0))) < 0.1
    error, turn = chain_error(postures, hold)
    assert error.max() < 1e-6 and turn.max() < 1e-6


def test_a_joint_that_is_off_opens_the_chain_by_its_lever(posture):
    hold = hold_at(posture, POSE)
    for angle in np.radians([0.1, 2.0]):
        off = posture.copy()
        off[12] += angle  # joint 6 of the left arm: the tool is on its axis
        error, turn = chain_error([off], hold)
        assert error[0] == pytest.approx(0.0, abs=1e-12) and turn[0] == pytest.approx(angle, rel=1e-9)
        off = posture.copy()
        off[7] += angle  # joint 1: about the vertical through the left arm's base
        error, turn = chain_error([off], hold)
        lever = np.hypot(*(tools_at([posture])[1][0, :2, 3] - fixed_pose("world", "left_base")[:2, 3]))
        assert error[0] == pytest.approx(2.0 * np.sin(angle / 2.0) * lever, rel=1e-9)
        assert turn[0] == pytest.approx(angle, rel=1e-9)


def test_hands_that_move_together_leave_the_chain_closed(posture):
    hold = hold_at(posture, POSE)
    moved = follow(object_path(POSE, [0.0, 0.0, 0.03], [1, 0, 0], 0.0, 0.01), hold, posture)[-1]
    assert chain_error([moved], hold)[0][0] < 1e-6


def test_a_way_out_of_reach_is_refused_with_arm_place_and_reason(posture):
    with pytest.raises(InputError, match=r"after \d+ % of the way the (right|left) arm cannot"):
        follow(object_path(POSE, [0.6, 0.0, 0.0], [0, 0, 1], 0.0, 0.02), hold_at(posture, POSE), posture)


@pytest.mark.parametrize(
    ("shift", "axis", "angle"),
    [
        ((0, 0), (0, 0, 1), 0.0),
        ((0, 0, np.nan), (0, 0, 1), 0.0),
        ((0, 0, 0), (0, 0, 0), 0.1),
        ((1e9, 0, 0), (0, 0, 1), 0.0),
    ],
)
def test_a_way_that_is_none_is_refused(shift, axis, angle):
    with pytest.raises(InputError):
        object_path(POSE, shift, axis, angle, 0.01)
