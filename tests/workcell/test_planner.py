"""Paths: from start to goal, free all along, no joint moved that need not move."""

import itertools

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.grasp import grasp_paths, with_arm, with_jaw
from hydrolek_drake.workcell.planner import path_is_free, plan_path
from hydrolek_drake.workcell.scene import home_posture


def test_a_free_straight_way_is_taken(clear):
    goal = home_posture()
    goal[1] += 0.1
    path = plan_path(clear, home_posture(), goal, np.random.default_rng(1))
    np.testing.assert_array_equal(path, [home_posture(), goal])


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_path_to_the_pipe_is_free_at_every_hundredth(clear, holding, pipe, seed):
    """Checked more finely than the planner does, with the bare shapes."""
    sight = pipe.point - [0.57, 0.0, 0.86]
    grasp = next(grasp_paths(pipe.point, pipe.axis, sight, 0.19, home_posture(), "right", clear, holding))
    goal = with_arm(with_jaw(home_posture(), "right", np.radians(40)), "right", grasp.angles[0])
    path = plan_path(clear, home_posture(), goal, np.random.default_rng(seed))
    np.testing.assert_array_equal(path[[0, -1]], [home_posture(), goal])
    np.testing.assert_array_equal(path[:, 7:], np.broadcast_to(home_posture()[7:], (len(path), 7)))
    bare = CollisionWorld(pipe, padding=0.0)
    for first, last in itertools.pairwise(path):
        for share in np.linspace(0, 1, 100):
            assert bare.free(first + share * (last - first))


def test_the_straight_way_between_crossed_sides_of_the_pipe_is_not_taken(clear, pipe):
    """Left of the pipe and right of it: straight across would hit it, the path goes round."""
    left, right = home_posture(), home_posture()
    # arm stretched at the pipe's height, to either side of it
    left[:6] = np.radians([22, 35, -25, 0, -10, 0])
    right[:6] = np.radians([2, 35, -25, 0, -10, 0])
    if not (clear.free(left) and clear.free(right)):
        left[1] = right[1] = np.radians(30)
    assert clear.free(left) and clear.free(right) and not clear.free_between(left, right)
    path = plan_path(clear, left, right, np.random.default_rng(4))
    # samples fall elsewhere on a shortened stretch, so a few millimetres of the 15 mm may be used up
    assert len(path) > 2 and path_is_free(CollisionWorld(pipe, padding=0.005), path)


def test_a_goal_that_touches_or_is_beyond_a_limit_is_refused(clear):
    touching, beyond = home_posture(), home_posture()
    touching[0], touching[7] = np.radians(25), np.radians(-25)
    with pytest.raises(InputError, match="goal of the path is nearer than 15 mm"):
        plan_path(clear, home_posture(), touching, np.random.default_rng(1))
    beyond[9] = np.radians(30)
    with pytest.raises(InputError, match="start of the path has joint 3 of the left arm beyond"):
        plan_path(clear, beyond, home_posture(), np.random.default_rng(1))
