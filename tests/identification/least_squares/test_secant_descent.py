"""Least squares with few Jacobians ends where it does with many, and its slopes agree with what was seen."""

from collections.abc import Sequence

import numpy as np
import pytest

from hydrolek_drake.identification.least_squares.least_squares import fit_from
from hydrolek_drake.identification.least_squares.secant_descent import SecantDescent, corrected
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem

PATHS = ["supply.pressure", "valve.max_area_a", "load.gravity_cos", "fluid.bulk_modulus"]
ALL = np.ones(4, dtype=bool)


class Counting(Problem):
    """Counts its Jacobians."""

    jacobians = 0

    def jacobian(self, unit, at=None, moving=None) -> np.ndarray:
        self.jacobians += 1
        return super().jacobian(unit, at, moving)


@pytest.fixture(scope="module")
def planted(bench, recorded):
    truth = {"supply.pressure": 17.2e6, "valve.max_area_a": 0.61e-6, "load.gravity_cos": 247.0}
    return recorded(bench.with_values(truth), bench)


def test_it_ends_at_the_least_squares_with_few_jacobians(bench, planted) -> None:
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    start = parameters.unit()
    least = fit_from(Problem(parameters, planted), start, tolerance=1e-10)
    problem = Counting(parameters, planted)
    descent = SecantDescent(problem, worth=0.01, stop=lambda: False, moving=ALL)
    found = descent.from_start(start)
    assert found.evaluations == problem.evaluations
    assert found.objective == pytest.approx(least.objective, abs=0.1)
    assert found.objective < problem.residuals(start) @ problem.residuals(start) / 10.0
    assert problem.jacobians <= 3
    assert problem.jacobian(found.unit) == pytest.approx(found.jacobian)


def test_held_parameters_stay_and_the_others_keep_to_their_ranges(bench, planted) -> None:
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    start = parameters.unit()
    moving = np.array([True, False, True, False])
    seen = []

    class Watched(Problem):
        def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
            seen.extend(unit.copy() for unit in units)
            return super().residuals_of_all(units)

    start[0] = 0.01  # at the end of its range, far from the supply's true pressure
    watched = Watched(parameters, planted)
    found = SecantDescent(watched, worth=1.0, stop=lambda: False, moving=moving).from_start(start)
    assert found.unit[~moving] == pytest.approx(start[~moving], abs=0.0)
    assert np.min(seen) >= 0.0 and np.max(seen) <= 1.0 + 1e-5  # by a difference at most


def test_it_ends_where_it_is_told_to_stop(bench, planted) -> None:
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    with pytest.raises(KeyboardInterrupt):
        descent = SecantDescent(Problem(parameters, planted), worth=1.0, stop=lambda: True, moving=ALL)
        descent.from_start(parameters.unit())


def test_a_corrected_jacobian_agrees_with_every_way_and_is_left_alone_across_them() -> None:
    rng = np.random.default_rng(1)
    jacobian, ways, changes = rng.normal(size=(7, 4)), rng.normal(size=(2, 4)), rng.normal(size=(2, 7))
    told = corrected(jacobian, list(ways), list(changes))
    for way, change in zip(ways, changes, strict=True):
        assert told @ way == pytest.approx(change)
    across = np.linalg.svd(ways)[2][2:]
    assert told @ across.T == pytest.approx(jacobian @ across.T)
    assert corrected(jacobian, [], []) is jacobian
