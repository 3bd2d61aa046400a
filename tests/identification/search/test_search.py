"""All searches behind one interface: they find, they keep their budget, they survive, they resume."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.objective.output_error import OutputError
from hydrolek_drake.identification.search import METHODS, search
from hydrolek_drake.identification.search.evaluation import FAILED
from hydrolek_drake.identification.search.journal import Journal

TIME = np.linspace(0.0, 3.0, 80)
TRUE = np.array([2.0, 1.5])
LOWER, UPPER = np.array([0.5, 0.2]), np.array([4.0, 5.0])


def decay(point):
    return point[0] * np.exp(-point[1] * TIME)


def objective_for(method, model=decay):
    return OutputError(model, decay(TRUE), p=2.0, segments=4 if method == "nsga2" else None)


def run(method, budget=600, seed=3, model=decay, **options):
    rng = np.random.default_rng(seed)
    return search(method, objective_for(method, model), LOWER, UPPER, budget, rng, **options)


@pytest.mark.parametrize(
    ("method", "error"), [("ga", 0.3), ("nsga2", 0.3), ("de", 0.01), ("cma", 1e-3), ("least-squares", 1e-6)]
)
def test_each_method_finds_a_decay_within_its_budget(method, error):
    result = run(method)
    assert result.evaluations <= 600
    np.testing.assert_allclose(result.point, TRUE, atol=error)
    assert np.all(np.diff(result.learning_curve) <= 0.0)


def test_multi_objective_search_averages_the_best_of_each_segment():
    result = run("nsga2")
    points, values = result.pareto
    best = points[np.argmin(values, axis=0)]
    np.testing.assert_array_equal(result.best_per_segment, best)
    np.testing.assert_allclose(result.point, best.mean(axis=0))


@pytest.mark.parametrize("method", METHODS)
def test_the_seed_decides(method):
    first, again, other = run(method, 150), run(method, 150), run(method, 150, seed=4)
    np.testing.assert_array_equal(first.units, again.units)
    assert not np.array_equal(first.units, other.units)


def failing(point):
    if point[0] > 3.0:
        raise ZeroDivisionError
    return np.full_like(TIME, np.nan) if point[1] > 4.0 else decay(point)


@pytest.mark.parametrize("method", ["ga", "nsga2", "de", "cma"])
def test_an_evaluation_that_fails_or_diverges_is_the_worst_score_and_stops_nothing(method):
    result = run(method, 400, model=failing)
    points = LOWER + result.units * (UPPER - LOWER)
    bad = (points[:, 0] > 3.0) | (points[:, 1] > 4.0)
    assert bad.any()
    assert np.all(result.scores[bad] == FAILED) and np.all(result.scores[~bad] < FAILED)
    np.testing.assert_allclose(result.point, TRUE, atol=0.4)


@pytest.mark.parametrize("method", ["ga", "nsga2", "de", "cma"])
def test_an_interrupted_search_resumes_to_the_result_of_an_unbroken_one(method, tmp_path):
    unbroken = run(method, 300)
    calls = []

    def interrupting(point):
        calls.append(1)
        if len(calls) == 123:
            raise KeyboardInterrupt
        return decay(point)

    def journal():
        size = 4 if method == "nsga2" else 1
        return Journal(tmp_path / "journal", {"method": method, "seed": 3}, 2, size)

    def one_by_one(objective):
        return lambda points: [objective(point) for point in points]

    broken = search(
        method,
        objective_for(method, interrupting),
        LOWER,
        UPPER,
        300,
        np.random.default_rng(3),
        journal=journal(),
        evaluate=one_by_one(objective_for(method, interrupting)),
    )
    assert broken.interrupted and broken.evaluations < 123
    with (tmp_path / "journal").open("ab") as file:
        file.write(b"torn")  # as a crash in the middle of a write leaves it
    counted = []

    def counting(point):
        counted.append(1)
        return decay(point)

    resumed = run(method, 300, model=counting, journal=journal())
    np.testing.assert_array_equal(resumed.units, unbroken.units)
    np.testing.assert_array_equal(resumed.point, unbroken.point)
    assert len(counted) <= 300 - broken.evaluations + 1  # the average of nsga2 is looked at once more


def test_a_journal_of_another_search_is_refused(tmp_path):
    run("de", 50, journal=Journal(tmp_path / "j", {"method": "de", "seed": 3}, 2, 1))
    with pytest.raises(InputError, match="belongs to another search"):
        Journal(tmp_path / "j", {"method": "de", "seed": 4}, 2, 1)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("annealing", LOWER, UPPER, 10), "choose ga, nsga2, de, cma, least-squares"),
        (("cma", LOWER[:1], UPPER[:1], 10), "two parameters or more"),
        (("de", UPPER, LOWER, 10), "a range is empty"),
        (("de", LOWER, UPPER, 0), "choose 1 or more"),
    ],
)
def test_a_search_that_cannot_be_is_refused(arguments, said):
    method, lower, upper, budget = arguments
    with pytest.raises(InputError, match=said):
        search(method, objective_for("de"), lower, upper, budget, np.random.default_rng(0))


def test_segments_need_the_multi_objective_search():
    with pytest.raises(InputError, match="use nsga2"):
        search("de", objective_for("nsga2"), LOWER, UPPER, 10, np.random.default_rng(0))
