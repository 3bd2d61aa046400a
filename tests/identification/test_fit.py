"""Fits of the bench: every method runs on recordings, says what it knows, resumes, and refuses bad input."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit import fit_rig
from hydrolek_drake.identification.fit.report import sentences, write_fit
from hydrolek_drake.identification.fit.rig_objective import RigObjective
from hydrolek_drake.identification.least_squares.least_squares import multi_start
from hydrolek_drake.identification.parameter_set import ParameterSet, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig

BENCH = Path(__file__).parents[1] / "data" / "bench" / "practice_01"
TWO = ["valve.max_area_a", "command.delay"]


@pytest.fixture(scope="module")
def rig():
    return load_rig("joint_bench")


@pytest.fixture(scope="module")
def recording(rig):
    return read_recording(BENCH / "train.csv", rig.columns)


@pytest.fixture(scope="module")
def short(recording):
    """Its beginning, where a search is to run and not to arrive."""
    return recording.between(0.0, 8.0)


@pytest.fixture(scope="module")
def fitted(rig, recording):
    holdout = read_recording(BENCH / "holdout.csv", rig.columns)
    return fit_rig(rig, [recording], holdout=[holdout])


def test_least_squares_reaches_the_noise_on_a_healthy_bench(fitted):
    assert fitted.over_noise < 1.05
    assert fitted.holdout_over_noise < 1.06
    assert "reaches the noise" in sentences(fitted)[0]


def test_intervals_hold_the_value_and_the_range(fitted):
    for free in fitted.parameters.free:
        value, low, high = fitted.intervals()[free.path]
        assert free.lower <= low <= value <= high <= free.upper


def test_fitted_rig_is_written_and_loads_with_the_values(fitted, tmp_path):
    write_fit(fitted, tmp_path)
    again = load_rig(tmp_path / "rig_fitted.yaml")
    for path, (value, _, _) in fitted.intervals().items():
        assert again.value(path) == pytest.approx(value)


def test_segments_of_the_rig_s_objective_together_are_the_whole(rig, recording):
    problem = Problem(ParameterSet(rig, free_parameters(rig)), experiments_of(rig, recording))
    unit = problem.parameters.unit()
    whole = RigObjective(problem, p=2.0)(unit)[0]
    parts = RigObjective(problem, p=2.0, segments=8)(unit)
    assert np.sqrt(np.mean(parts**2)) == pytest.approx(whole, rel=0.01)
    assert RigObjective(problem, p=np.inf)(unit)[0] == pytest.approx(
        RigObjective(problem, p=np.inf, segments=8)(unit).max()
    )


@pytest.mark.parametrize("method", ["ga", "nsga2", "de", "cma"])
def test_each_search_comes_no_worse_than_the_rig_s_own_values(method, rig, short):
    found = fit_rig(rig, [short], method, paths=TWO, budget=60, p=2.0, segments=2)
    problem = Problem(found.parameters, experiments_of(rig, short))
    begun = problem.residuals(found.parameters.unit())
    at_start = np.sqrt(begun @ begun / problem.counted)
    assert found.search.scores.mean(axis=1).min() <= at_start * (1.0 + 1e-9)
    assert found.evaluations == 60


def test_a_fit_resumes_from_its_checkpoint_to_the_same_result(rig, short, tmp_path):
    def run_fit(budget, checkpoint):
        return fit_rig(rig, [short], "de", paths=TWO, budget=budget, checkpoint=checkpoint)

    unbroken = run_fit(60, None)
    run_fit(25, tmp_path / "checkpoint")
    resumed = run_fit(60, tmp_path / "checkpoint")
    np.testing.assert_array_equal(resumed.unit, unbroken.unit)
    with pytest.raises(InputError, match="belongs to another search"):
        fit_rig(rig, [short], "de", paths=TWO[:1], budget=5, checkpoint=tmp_path / "checkpoint")


def test_a_constant_command_is_refused(rig, recording, tmp_path):
    lines = (BENCH / "train.csv").read_text().splitlines()
    column = lines[0].split(",").index("joint.command_V")
    rows = [line.split(",") for line in lines[1:400]]
    for row in rows:
        row[column] = "2.0"
    path = tmp_path / "constant.csv"
    path.write_text("\n".join([lines[0], *(",".join(row) for row in rows)]) + "\n")
    with pytest.raises(InputError, match="nothing can be identified"):
        fit_rig(rig, [read_recording(path, rig.columns)])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--method", "annealing"], "choose ga, nsga2, de, cma, least-squares"),
        (["--parameter", "valve.area"], "has no parameter 'valve.area'"),
        (["--parameter", "fluid.density"], "has no range"),
        (["--norm", "3"], "choose 1, 2, inf"),
        (["--loss", "square"], "choose linear"),
        (["--cluster", "tcp://127.0.0.1:1"], "least-squares runs in threads"),
        (["--overdue", "5"], "least-squares runs in threads"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, said, capsys):
    status = run(["fit", "joint_bench", str(BENCH / "train.csv"), *arguments])
    error = capsys.readouterr().err
    assert status == 2 and said in error and error.count("\n") == 1


def test_an_empty_range_is_refused(tmp_path, capsys):
    tree = yaml.safe_load((Path(load_rig("joint_bench").path)).read_text())
    tree["supply"]["pressure"]["range"] = [16, 16]
    (tmp_path / "rig.yaml").write_text(yaml.safe_dump(tree))
    assert run(["fit", str(tmp_path / "rig.yaml"), str(BENCH / "train.csv")]) == 2
    assert "range" in capsys.readouterr().err


def test_interrupted_least_squares_gives_the_best_finished_start(rig, recording):
    def stop(evaluations, best):
        raise KeyboardInterrupt

    found = fit_rig(rig, [recording], paths=TWO, progress=stop)
    assert found.interrupted
    assert "would start anew" in sentences(found)[-1]
    problem = Problem(found.parameters, experiments_of(rig, recording))
    begun = problem.residuals(found.parameters.unit())
    assert found.over_noise < np.sqrt(begun @ begun / problem.counted)


@pytest.mark.parametrize("pair", ["practice_01", "practice_02"])
@pytest.mark.thorough
def test_random_starts_reach_the_noise_on_holdout(pair, rig):
    train, holdout = (
        Problem(
            ParameterSet(rig, free_parameters(rig)),
            experiments_of(rig, read_recording(BENCH.parent / pair / f"{part}.csv", rig.columns)),
        )
        for part in ("train", "holdout")
    )
    start = np.random.default_rng(1).uniform(size=(2, len(train.parameters)))
    best = multi_start(train, start)
    residuals = holdout.residuals(best.unit)
    assert np.sqrt(residuals @ residuals / holdout.counted) < 1.05
