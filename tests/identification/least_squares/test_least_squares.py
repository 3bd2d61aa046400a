"""Fits: planted values come back, with intervals that hold them, from any start."""

from collections.abc import Sequence
from pathlib import Path
from typing import ClassVar

import numpy as np
import pytest

from hydrolek_drake.diagnosis.intervals.curvature import intervals_of
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.least_squares.least_squares import fit_from, fit_from_afar, multi_start
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.recordings import read_recording

BENCH = Path(__file__).parents[2] / "data" / "bench"

PATHS = ["supply.pressure", "valve.max_area_a", "load.gravity_cos", "command.delay"]


@pytest.fixture(scope="module")
def planted(bench, recorded):
    truth = {
        "supply.pressure": 17.2e6,
        "valve.max_area_a": 0.61e-6,
        "load.gravity_cos": 247.0,
        "command.delay": 0.0212,
    }
    return truth, recorded(bench.with_values(truth), bench)


def test_planted_values_are_recovered_within_their_intervals(bench, planted) -> None:
    truth, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    fit = fit_from(Problem(parameters, experiments), parameters.unit())
    assert fit.over_noise == pytest.approx(1.0, abs=0.05)
    known = intervals_of(parameters, fit)
    for path, value in truth.items():
        interval = known[bench.full_path(path)]
        width = interval.high - interval.low
        # twice the half width of a 95 % interval: four standard deviations
        assert abs(interval.value - value) < width
        assert interval.low < interval.value < interval.high


def test_the_same_optimum_from_several_starts(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    problem = Problem(parameters, experiments, 1e-3)
    rng = np.random.default_rng(3)
    ends = [fit_from(problem, rng.uniform(0.1, 0.9, len(parameters))).chi_squared for _ in range(3)]
    assert max(ends) - min(ends) < 1.0


def test_random_starts_end_at_the_noise_with_all_parameters_free(bench) -> None:
    parameters = ParameterSet(bench, free_parameters(bench))
    recording = read_recording(BENCH / "practice_02" / "train.csv", bench.columns)
    problem = Problem(parameters, [e.until(12.0) for e in experiments_of(bench, recording)], 1e-3)
    starts = np.random.default_rng(1).uniform(size=(3, len(parameters)))
    assert [fit_from_afar(problem, start).over_noise < 1.05 for start in starts] == [True] * 3


def test_several_starts_end_early_at_the_noise(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    tried = []
    problem = Problem(parameters, experiments, 1e-3)
    starts = [parameters.unit(), np.full(4, 0.2), np.full(4, 0.8)]
    multi_start(problem, starts, good_enough=1.2, progress=lambda number, fit: tried.append(number))
    assert tried == [0]


@pytest.mark.parametrize("place", [0.3, 0.5, 0.6])
def test_the_jacobian_is_that_of_central_differences_with_a_far_shorter_step(bench, planted, place) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    unit = np.full(4, place)
    jacobian = Problem(parameters, experiments, 0.25e-3).jacobian(unit)
    exact = Problem(parameters, experiments, 0.05e-3)
    for i, path in enumerate(PATHS):
        h = np.zeros(4)
        h[i] = 0.25e-3 / parameters.per_place(unit)[i] if path == "command.delay" else 1e-5
        central = (exact.residuals(unit + h) - exact.residuals(unit - h)) / (2.0 * h[i])
        assert np.linalg.norm(jacobian[:, i] - central) < 0.03 * np.linalg.norm(central)


class Counting(Problem):
    """Remembers the steps of its rollouts."""

    steps: ClassVar[list[float | None]] = []

    def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        self.steps.extend([self.longest_step] * len(units))
        return super().residuals_of_all(units)


class Jumping(Problem):
    """From a place on a joint stops in the last third, by a hair's breadth of the second parameter."""

    edge = 0.0

    def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        found = super().residuals_of_all(units)
        for unit, left in zip(units, found, strict=True):
            left[2 * left.size // 3 :] += 1.0 if unit[1] > self.edge else 0.0
        return found


@pytest.mark.parametrize("aside", [-3e-7, 3e-7])
def test_a_jump_within_a_difference_does_not_make_a_parameter_look_known(bench, planted, aside) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    unit = np.full(4, 0.4)
    smooth = Problem(parameters, experiments).jacobian(unit)
    problem = Jumping(parameters, experiments)
    problem.edge = unit[1] + aside
    at = problem.residuals(unit)
    told = problem.jacobian_without_jumps(unit, at)
    assert np.linalg.norm(told - smooth, axis=0) == pytest.approx(
        0.0, abs=1e-2 * np.linalg.norm(smooth[:, 1])
    )
    if aside > 0.0:  # the side on which the Jacobian looks
        assert np.linalg.norm(problem.jacobian(unit, at)[:, 1]) > 10.0 * np.linalg.norm(smooth[:, 1])


def test_slopes_that_lead_a_search_are_the_jacobian_for_less(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    problem, unit = Counting(parameters, experiments, 0.5e-3), np.full(4, 0.4)
    at = problem.residuals(unit)
    exact = problem.jacobian(unit, at)
    problem.steps.clear()
    leading = problem.leading_slopes(unit, at)
    # one rollout with the own step to hold them against it
    assert problem.steps == [1e-3] * 5 + [0.5e-3]
    assert (np.linalg.norm(leading - exact, axis=0) < 0.5 * np.linalg.norm(exact, axis=0)).all()


def test_nothing_but_the_jacobian_leads_where_a_longer_step_goes_astray(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    problem, unit = Problem(parameters, experiments, 8e-3), np.full(4, 0.4)
    at = problem.residuals(unit)
    assert problem.leading_slopes(unit, at) is None


def test_a_prior_keeps_what_the_data_do_not_tell(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    tight = Problem(parameters, experiments, 1e-3, prior=np.full(4, 1e-6))
    fit = fit_from(tight, parameters.unit())
    assert fit.unit == pytest.approx(parameters.unit(), abs=1e-3)


def test_a_diverged_simulation_is_scored_not_raised(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    residuals = Problem.bounded([np.array([1.0, np.nan, -1e30])])
    assert np.isfinite(residuals).all() and abs(residuals).max() == 1e7
    assert np.isfinite(Problem(parameters, experiments, 0.5).residuals(np.full(4, 0.5))).all()


def test_held_parameters_stay_and_the_others_end_where_they_would_alone(bench, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(bench, free_parameters(bench, PATHS))
    problem = Problem(parameters, experiments, 1e-3)
    start = parameters.unit()
    moving = np.array([path.endswith(("max_area_a", "delay")) for path in parameters.paths])
    held = fit_from(problem, start, moving=moving)
    assert held.unit[~moving] == pytest.approx(start[~moving], abs=1e-12)
    assert not held.jacobian[:, ~moving].any()
    fewer = ParameterSet(bench, free_parameters(bench, ["valve.max_area_a", "command.delay"]))
    alone = fit_from(Problem(fewer, experiments, 1e-3), fewer.unit())
    assert held.chi_squared == pytest.approx(alone.chi_squared, rel=1e-6)
    known = dict(zip(fewer.paths, alone.unit, strict=True))
    found = {p: u for p, u, m in zip(parameters.paths, held.unit, moving, strict=True) if m}
    assert found == {path: pytest.approx(known[path], abs=1e-4) for path in found}
