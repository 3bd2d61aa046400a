"""Steps of fits by observers, which are held to the prior far from the noise."""

import numpy as np
import pytest

from hydrolek_drake.identification.least_squares.normal_equations import NormalEquations
from hydrolek_drake.identification.least_squares.place import Place

VALUES = 400


class Linear:
    """Residuals r + J d of two numbers, the second poorly told; a prior of standard deviation 0.3 about the middle."""

    def __init__(self, size: float, pull_time: float | None) -> None:
        rng = np.random.default_rng(3)
        self.slopes = rng.standard_normal((VALUES, 2)) * (50.0, 0.5)
        self.left = size * rng.standard_normal(VALUES)
        self.counted, self.pull_time = VALUES, pull_time

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        return (unit - 0.5) / 0.3

    def prior_jacobian(self) -> np.ndarray:
        return np.eye(2) / 0.3

    def place(self) -> Place:
        moving = np.array([True, True])
        return Place(self, moving, np.array([0.5, 0.5]), self.left, self.slopes)  # type: ignore[arg-type]


def _step(size: float, pull_time: float | None) -> np.ndarray:
    return NormalEquations(Linear(size, pull_time).place()).step(1e-9)


@pytest.mark.parametrize("pull_time", [None, 0.1])
def test_at_the_noise_a_step_is_that_of_least_squares_with_the_prior(pull_time) -> None:
    told = Linear(0.9, pull_time)
    both = told.slopes.T @ told.slopes + np.eye(2) / 0.09
    expected = np.clip(np.linalg.solve(both, -told.slopes.T @ told.left), -0.5, 0.5)
    assert _step(0.9, pull_time) == pytest.approx(expected, rel=1e-4)


def test_far_from_it_an_observer_s_step_moves_what_is_told_and_leaves_what_is_not() -> None:
    free, held = _step(10.0, None), _step(10.0, 0.1)
    assert held[0] == pytest.approx(free[0], rel=0.05)  # as the data have it
    assert abs(held[1]) < 0.3 * abs(free[1])


def test_what_a_step_promises_is_the_fall_of_the_squares_and_of_the_prior() -> None:
    told = Linear(10.0, 0.1)
    plan = NormalEquations(told.place())
    way = plan.step(1.0)

    def squares(unit: np.ndarray) -> float:
        left, off = told.left + told.slopes @ (unit - 0.5), told.prior_residuals(unit)
        return float(left @ left + off @ off)

    start = np.array([0.5, 0.5])
    assert plan.promises(way) == pytest.approx(squares(start) - squares(start + way), rel=1e-9)
