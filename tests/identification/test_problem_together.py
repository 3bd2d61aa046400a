"""Fits of joints that move together: every residual from a rollout of all of them, whatever leads the search."""

import pickle

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.fitting import fit_rig
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether, problem_of
from hydrolek_drake.rigs import load_rig

pytestmark = pytest.mark.xdist_group("joints together")

TRUTH = {
    "joints.right_j2.cylinder.area_a": 1.04,  # times the rig's own
    "joints.right_j3.cylinder.area_a": 0.97,
    "joints.right_j2.amplifier.max_current_b": 0.98,
    "joints.right_j3.amplifier.max_current_a": 1.02,
}


@pytest.fixture(scope="module")
def machine(two_joints):
    return two_joints.with_values({path: two_joints.value(path) * size for path, size in TRUTH.items()})


@pytest.fixture(scope="module")
def planted(two_joints, machine, recorded_together):
    recording, _ = recorded_together(machine, 5, largest_V=4.0)
    return recording, experiments_of(two_joints, recording)


@pytest.mark.thorough
def test_a_fit_of_two_joints_by_command_finds_what_was_planted_to_the_noise(
    two_joints, machine, planted, recorded_together
) -> None:
    recording, experiments = planted
    ahead, _ = recorded_together(machine, 6, largest_V=4.0)
    found = fit_rig(two_joints, [recording], paths=list(TRUTH), holdout=[ahead])
    parameters = ParameterSet(two_joints, free_parameters(two_joints, list(TRUTH)))
    true = parameters.unit({path: machine.value(path) for path in TRUTH})

    def left(kind, experiments) -> float:
        residuals = kind(parameters, experiments).residuals(true)
        return float(np.sqrt(residuals @ residuals / sum(e.counted for e in experiments)))

    # as the machine's own numbers, but for the four that were fitted; shaking passes for noise, so this is below 1
    assert found.over_noise == pytest.approx(left(problem_of, experiments), rel=0.01)
    assert found.holdout_over_noise == pytest.approx(
        left(problem_of, experiments_of(two_joints, ahead)), rel=0.02
    )
    for path, (value, low, high) in found.intervals().items():
        assert low - (high - low) < machine.value(path) < high + (high - low), path  # four standard errors
        assert value == pytest.approx(machine.value(path), rel=0.01), path
    # by measured angles alone the machine's own numbers look as if something were missing
    assert left(Problem, experiments) > 1.2 * found.over_noise


def test_joints_that_move_alone_have_their_own_rollouts(bench, recorded) -> None:
    parameters = ParameterSet(bench, free_parameters(bench, ["supply.pressure"]))
    assert type(problem_of(parameters, recorded(bench, bench))) is Problem


def test_columns_of_joints_that_cannot_move_cost_nothing_and_are_zero(recorded_together) -> None:
    whole = load_rig("hydrolek", {})
    recording, _ = recorded_together(whole, 5, seconds=3.0)
    paths = ["joints.right_j2.cylinder.area_a", "joints.left_j2.cylinder.area_a"]
    parameters = ParameterSet(whole, free_parameters(whole, paths))
    problem = problem_of(parameters, experiments_of(whole, recording))
    unit = parameters.unit()
    base = problem.residuals(unit)
    rolled = []

    class Counted(type(problem._recordings[0])):
        def run(self, *given, **named):
            rolled.append(self)
            return super().run(*given, **named)

    for one in problem._recordings:
        one.__class__ = Counted
    slopes = problem.jacobian(unit, base)
    assert len(rolled) == 1
    assert np.any(slopes[:, 0]) and not np.any(slopes[:, 1])


def test_pulled_rollouts_are_each_joints_own_and_do_not_remember_free_ones(two_joints, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(two_joints, free_parameters(two_joints, list(TRUTH)))
    together, apart = (kind(parameters, experiments) for kind in (ProblemTogether, Problem))
    unit = parameters.unit()
    free = together.residuals(unit)
    together.jacobian(unit, free)
    np.testing.assert_array_equal(together.pulled(0.1).residuals(unit), apart.pulled(0.1).residuals(unit))
    np.testing.assert_array_equal(together.residuals(unit), free)


def test_it_goes_to_other_processes(two_joints, planted) -> None:
    _, experiments = planted
    parameters = ParameterSet(two_joints, free_parameters(two_joints, list(TRUTH)))
    here = problem_of(parameters, experiments)
    there = pickle.loads(pickle.dumps(here))
    unit = parameters.unit()
    np.testing.assert_array_equal(there.residuals(unit), here.residuals(unit))
