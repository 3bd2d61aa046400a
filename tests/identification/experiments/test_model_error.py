"""What a rig says that its equations leave at best is told from missing physics."""

import math

import numpy as np
import pytest

from hydrolek_drake.diagnosis.settings import GAINS
from hydrolek_drake.diagnosis.structures.cost import cost_of, gain_needed
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.least_squares.least_squares import fit_from
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out

NOISE_RAD = 8e-4


def _experiment(share: str):
    rig = load_rig("hopsan_link", {"integration.model_error": share, "integration.time_error": "0 ms"})
    time = np.arange(0.0, 4.0, 0.01)
    volts = 4.0 * np.sin(3.0 * time)
    done = roll_out(rig.records(), time, volts, time, longest_step=5e-4).signals
    noise = np.random.default_rng(1).normal(0.0, NOISE_RAD, time.size)
    signals = {"joint.command": volts, "joint.angle": done.reading + noise}
    [experiment] = experiments_of(rig, Recording("made", time, signals, "made.csv"))
    return rig, experiment


def test_no_error_is_stated_and_none_is_taken_off() -> None:
    _, experiment = _experiment("0 %")
    assert experiment.unsure == 0.0


def test_a_stated_error_may_leave_its_share_of_the_range() -> None:
    _, experiment = _experiment("0.1 %")
    [angle] = experiment.channels
    allowed = 1e-3 * float(np.ptp(angle.measured))
    assert experiment.unsure == pytest.approx(experiment.counted * (allowed / angle.noise) ** 2)
    assert angle.deviation == angle.noise  # weights stay as they are: it is no noise


def test_what_is_named_must_bring_more_than_that() -> None:
    rig, experiment = _experiment("0.1 %")
    parameters = ParameterSet(rig, free_parameters(rig, ["load.mass", "valve.discharge"]))
    fit = fit_from(Problem(parameters, [experiment]), parameters.unit())
    assert gain_needed(fit) == pytest.approx(experiment.unsure)
    assert gain_needed(fit) > max(GAINS.needed, GAINS.fidelity * experiment.counted)
    assert math.sqrt(fit.chi_squared / fit.counted) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("share", ["0 %", "1 %", "5 %"])
def test_the_cost_prefers_what_explains_more_than_that_and_not_what_explains_less(share: str) -> None:
    rig, experiment = _experiment(share)
    parameters = ParameterSet(rig, free_parameters(rig))
    problem = Problem(parameters, [experiment], experiment.longest_step)
    fit = fit_from(problem, parameters.unit({}))
    floor = fit.counted + fit.unsure
    far = 3.0 * floor  # what the nominal model leaves
    nominal = cost_of(fit, far, 0)
    assert cost_of(fit, 0.5 * fit.counted + 0.1 * floor, 1) < nominal  # takes two and a half times the floor
    assert cost_of(fit, far - 0.3 * GAINS.of_one_more(fit.counted, fit.unsure), 1) > nominal


def test_without_a_stated_error_squares_count_near_the_noise_and_shares_far_from_it() -> None:
    rig, experiment = _experiment("0 %")
    parameters = ParameterSet(rig, free_parameters(rig))
    fit = fit_from(Problem(parameters, [experiment], experiment.longest_step), parameters.unit({}))
    count = fit.counted
    assert cost_of(fit, 0.9 * count, 0) == pytest.approx(0.9 * count)
    assert cost_of(fit, 40.0 * count, 0) - cost_of(fit, 20.0 * count, 0) == pytest.approx(
        count * math.log(2.0)
    )
