"""Grasp and cut: the tool where it should be, pointing onto the pipe, in postures that touch nothing."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import direction_in_frame, in_frame
from hydrolek_drake.workcell.grasp import cut_path, directions_onto, grasp_paths, with_arm
from hydrolek_drake.workcell.scene import home_posture

CAMERA = np.array([0.57, 0.0, 0.86])


def _tool(side, angles):
    pose = tool_pose(angles)
    base = f"{side}_base"
    return (
        in_frame(pose[:3, 3], given_in=base, wanted_in="world"),
        direction_in_frame(pose[:3, 0], given_in=base, wanted_in="world"),
        direction_in_frame(pose[:3, 2], given_in=base, wanted_in="world"),
    )


def test_directions_come_square_and_frontal_first():
    axis, sight = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.3])
    found = directions_onto(axis, sight)
    assert found[0][0] == 0.0
    np.testing.assert_allclose(found[0][1], [1.0, 0.0, 0.0], atol=1e-12)
    for tilt, direction in found:
        assert np.linalg.norm(direction) == pytest.approx(1.0)
        assert direction @ axis == pytest.approx(np.sin(tilt))


def test_grasp_ends_on_the_axis_with_the_jaws_parallel_to_the_pipe(clear, holding, pipe):
    found = next(
        grasp_paths(pipe.point, pipe.axis, pipe.point - CAMERA, 0.19, home_posture(), "right", clear, holding)
    )
    for angles, wanted in zip(found.angles, found.points, strict=True):
        point, direction, jaws = _tool("right", angles)
        np.testing.assert_allclose(point, wanted, atol=1e-6)
        np.testing.assert_allclose(direction, found.direction, atol=1e-6)
        # parallel as far as the direction is square to the pipe
        assert abs(jaws @ pipe.axis) == pytest.approx(np.cos(found.tilt), abs=1e-6)
    np.testing.assert_allclose(found.points[-1], pipe.point, atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(found.points[0] - pipe.point), 0.19)
    opened = with_arm(home_posture(), "right", found.angles[0])
    assert clear.free(opened)


def test_cut_crosses_the_pipe_with_the_blade_and_clears_it_on_both_sides(clear, pipe):
    point, reach, blade = pipe.point + 0.15 * pipe.axis, 0.0775, 0.2
    found = cut_path(point, pipe.axis, point - CAMERA, reach, blade, home_posture(), "left", clear)
    tips = []
    for angles in found.angles:
        position, direction, _ = _tool("left", angles)
        tips.append(position + blade * direction)
    tips = np.array(tips)
    np.testing.assert_allclose(tips.mean(axis=0), point, atol=1e-6)
    across = tips[-1] - tips[0]
    assert np.linalg.norm(across) == pytest.approx(2 * reach, abs=1e-6)
    assert across @ pipe.axis == pytest.approx(0.0, abs=1e-6)
    assert min(np.linalg.norm(tip[:2] - pipe.point[:2]) for tip in (tips[0], tips[-1])) > pipe.radius


def test_a_point_out_of_reach_is_refused_with_the_reason(clear, holding, pipe):
    far = pipe.point + np.array([1.0, 0.0, 0.0])
    with pytest.raises(InputError, match=r"right arm cannot grasp there: .* long at most"):
        next(grasp_paths(far, pipe.axis, far - CAMERA, 0.19, home_posture(), "right", clear, holding))
    with pytest.raises(InputError, match="left arm cannot cut there"):
        cut_path(far, pipe.axis, far - CAMERA, 0.08, 0.2, home_posture(), "left", clear)
