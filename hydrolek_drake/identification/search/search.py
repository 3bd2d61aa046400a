"""One interface to all searches."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.choices import METHODS
from hydrolek_drake.identification.search.evaluation import BudgetSpent, Evaluator, Mapping
from hydrolek_drake.identification.search.genetic.settings import MULTI_TEXT, SIMPLE, GeneticSettings
from hydrolek_drake.identification.search.journal import Journal


@dataclass(frozen=True)
class SearchResult:
    """What a search found.

    Attributes:
        method: its name.
        point: the solution: the best that was evaluated; for nsga2 the average of each segment's best.
        value: objective there; for nsga2 the mean over the segments.
        units: places of the unit cube that were evaluated, in order. # (k, d)
        scores: their values. # (k, size)
        pareto: for nsga2: points and values of the Pareto set, else None.
        best_per_segment: for nsga2: its best of each segment. # (segments, d)
        seconds: how long it took.
        interrupted: whether Ctrl-C ended it.
    """

    method: str
    point: np.ndarray
    value: float
    units: np.ndarray
    scores: np.ndarray
    pareto: tuple[np.ndarray, np.ndarray] | None
    best_per_segment: np.ndarray | None
    seconds: float
    interrupted: bool

    @property
    def evaluations(self) -> int:
        """How many there were."""
        return len(self.units)

    @property
    def learning_curve(self) -> np.ndarray:
        """Least value, mean over the segments, after each evaluation. # (k,)."""
        return np.minimum.accumulate(self.scores.mean(axis=1))


def search(
    method: str,
    objective: Any,
    lower: np.ndarray,
    upper: np.ndarray,
    budget: int,
    rng: np.random.Generator,
    *,
    settings: GeneticSettings | None = None,
    first: np.ndarray | None = None,
    evaluate: Mapping | None = None,
    journal: Journal | None = None,
    progress: Callable[[int, float], None] | None = None,
    loss: str = "linear",
) -> SearchResult:
    """Make an objective small within a box.

    Args:
        method: one of `METHODS`.
        objective: point (d,) -> values, with `size`; for least squares also `residuals` and `score` (see
            `OutputError`).
        lower: ends of the box. # (d,)
        upper: # (d,)
        budget: evaluations that are allowed.
        rng: all random numbers.
        settings: of a genetic algorithm; None for the thesis's own.
        first: points to begin with. # (k, d)
        evaluate: evaluates several points at once (`workers`); None for one by one.
        journal: where evaluations are kept, to resume from.
        progress: told how many evaluations are done, and the best value.
        loss: robust loss of the least squares.

    Raises:
        InputError: unknown method, empty box, or an objective that does not fit the method.
    """
    lower, upper = np.asarray(lower, dtype=float), np.asarray(upper, dtype=float)
    size = int(getattr(objective, "size", 1))
    _check(method, lower, upper, budget, size)
    evaluator = Evaluator(
        objective, lower, upper, budget, size=size, evaluate=evaluate, journal=journal, progress=progress
    )
    starts = None if first is None else np.clip((np.atleast_2d(first) - lower) / (upper - lower), 0.0, 1.0)
    begun = time.perf_counter()
    interrupted = False
    try:
        if method == "ga":
            from hydrolek_drake.identification.search.genetic.simple import run_simple

            run_simple(evaluator, settings or SIMPLE, rng, starts)
        elif method == "nsga2":
            from hydrolek_drake.identification.search.genetic.multi_objective import run_multi_objective

            run_multi_objective(evaluator, settings or MULTI_TEXT, rng, starts)
        elif method == "de":
            from hydrolek_drake.identification.search.differential_evolution import run_differential_evolution

            run_differential_evolution(evaluator, rng, starts)
        elif method == "cma":
            from hydrolek_drake.identification.search.cma_es import run_cma_es

            run_cma_es(evaluator, rng, starts)
        else:
            from hydrolek_drake.identification.search.multi_start import run_multi_start

            run_multi_start(evaluator, objective.residuals, rng, starts, loss)
    except BudgetSpent:
        pass
    except KeyboardInterrupt:
        if not evaluator.units:
            raise
        interrupted = True
    return _result(method, evaluator, time.perf_counter() - begun, interrupted)


def _check(method: str, lower: np.ndarray, upper: np.ndarray, budget: int, size: int) -> None:
    if method not in METHODS:
        raise InputError(f"search: method '{method}' is unknown; choose {', '.join(METHODS)}")
    if lower.shape != upper.shape or not np.all(lower < upper):
        raise InputError("search: a range is empty; each lower end must lie below its upper end")
    if budget < 1:
        raise InputError(f"search: a budget of {budget} evaluations allows nothing; choose 1 or more")
    if method == "cma" and lower.size < 2:
        raise InputError(
            "search: cma adapts a covariance and needs two parameters or more; choose de for one"
        )
    if size > 1 and method != "nsga2":
        raise InputError(f"search: {method} takes one objective, not {size} segments; use nsga2")


def _result(method: str, evaluator: Evaluator, seconds: float, interrupted: bool) -> SearchResult:
    units, scores = np.array(evaluator.units), np.array(evaluator.scores)
    best = int(np.argmin(scores.mean(axis=1)))
    result = SearchResult(
        method=method,
        point=evaluator.point(units[best]),
        value=float(scores[best].mean()),
        units=units,
        scores=scores,
        pareto=None,
        best_per_segment=None,
        seconds=seconds,
        interrupted=interrupted,
    )
    if method != "nsga2":
        return result
    from hydrolek_drake.identification.search.genetic.multi_objective import pareto_set

    front = pareto_set(np.array([evaluator.point(unit) for unit in units]), scores)
    final = front.average
    return replace(
        result,
        point=final,
        value=float(np.mean(evaluator.objective(final))),
        pareto=(front.points, front.values),
        best_per_segment=front.best_per_segment,
    )
