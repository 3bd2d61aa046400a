"""The thesis's iterative inverse: (5.7) is the best step, and it converges as Table 5.3 says."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import arm_chain, joint_limits
from hydrolek_drake.kinematics.forward import wrist_position
from hydrolek_drake.kinematics.jacobian import wrist_jacobian
from hydrolek_drake.kinematics.jacobian_transpose import jacobian_transpose


def _postures(count, seed):
    lower, upper = joint_limits("right")
    angles = np.zeros((count, 6))
    angles[:, :5] = np.random.default_rng(seed).uniform(lower[:5], upper[:5], (count, 5))
    return angles


def test_one_step_is_5_6_with_5_7():
    start, goal = _postures(2, 1)
    miss = wrist_position(goal) - wrist_position(start)
    jacobian = wrist_jacobian(start)
    step = jacobian.T @ miss
    alpha = (np.linalg.norm(step) / np.linalg.norm(jacobian @ step)) ** 2
    once = jacobian_transpose(wrist_position(goal), start, tolerance=1e-9, most_iterations=1, clamped=False)
    np.testing.assert_allclose(once.angles[:5], start[:5] + alpha * step, rtol=0, atol=1e-12)
    assert once.iterations == 1 and not once.converged


@pytest.mark.parametrize("tolerance", [5e-3, 2e-3, 1e-3, 5e-4, 1e-4])
def test_400_random_targets_end_within_tolerance_as_a_rule(tolerance):
    """Table 5.3: the mean error without outliers lies at the tolerance (thesis: 0.97 to 1.4 times)."""
    postures = _postures(401, 2)
    angles, errors = postures[0], []
    for target in wrist_position(postures[1:]):
        result = jacobian_transpose(target, angles, tolerance=tolerance, most_iterations=5000)
        assert result.error == pytest.approx(np.linalg.norm(wrist_position(result.angles) - target))
        errors.append(result.error)
        angles = result.angles
    errors = np.array(errors)
    assert np.mean(errors <= tolerance) > 0.95
    assert 0.6 * tolerance < errors[errors <= 0.01].mean() < 1.4 * tolerance


def test_steps_stay_within_the_limits():
    chain = arm_chain("right", "wrist")
    result = jacobian_transpose([2.0, 0.0, 0.0], chain.middle, tolerance=1e-3, most_iterations=50)
    assert not result.converged
    assert np.all(result.angles >= chain.lower) and np.all(result.angles <= chain.upper)


def test_bad_input_is_refused():
    with pytest.raises(InputError, match="tolerance"):
        jacobian_transpose([1.0, 0.0, 0.0], np.zeros(6), tolerance=0.0, most_iterations=1)
    with pytest.raises(InputError, match="shape"):
        jacobian_transpose([1.0, 0.0], np.zeros(6), tolerance=1e-3, most_iterations=1)
