"""The study of thesis sections 4.5 and 4.6: genetic algorithms on the mechanical model, and others beside."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.identification.mechanical.mechanical_model import (
    MechanicalModel,
    mechanical_data,
    mechanical_parameters,
    simulated_experiment,
)
from hydrolek_drake.identification.objective.output_error import OutputError
from hydrolek_drake.identification.search.genetic.multi_objective import pareto_set
from hydrolek_drake.identification.search.genetic.settings import SIMPLE, GeneticSettings
from hydrolek_drake.identification.search.search import METHODS, SearchResult, search
from hydrolek_drake.yaml_files import package_yaml

OF_OBJECTIVE = ("p", "relative", "segments", "scale")

_Map = Callable[[np.ndarray], np.ndarray]

SCALES: dict[str, tuple[_Map, _Map]] = {"linear": (np.asarray, np.asarray), "log": (np.log, np.exp)}
"""Name -> how a parameter stands in its range, and back."""


@dataclass(frozen=True)
class _Scaled:
    """A model whose parameters come on one of `SCALES`; can be sent to workers."""

    model: MechanicalModel
    scale: str

    def __call__(self, point: np.ndarray) -> np.ndarray:
        return self.model(SCALES[self.scale][1](point))


@cache
def study_data() -> dict[str, Any]:
    """Content of `study.yaml`."""
    return package_yaml(__package__, "study.yaml")


def recommended() -> dict[str, Any]:
    """What is changed of objective and settings in the multi-objective search that we recommend."""
    data = study_data()
    return {"segments": data["segments"], **data["multi_objective"][data["recommended"]]}


@dataclass(frozen=True)
class Run:
    """One search of the study.

    Attributes:
        row: of which table row.
        method: of `search`.
        budget: evaluations that count.
        estimate: chromosome. # (9,)
        relative_errors: of it. # (9,)
        output_error: largest |error| of joint 2 [deg], the output error index of Table 4.3.
        mean_squared_error: of joint 2 [deg^2].
        learning: least objective after each evaluation, and the objective at the end of range of the first
            generation, for normalized curves. # (evaluations,)
    """

    row: str
    method: str
    budget: int
    estimate: np.ndarray
    relative_errors: np.ndarray
    output_error: float
    mean_squared_error: float
    learning: np.ndarray


class Study:
    """Data, objective and searches; each run has a seed of its own."""

    def __init__(self, seed: int, runs: int, noise_deg: float = 0.0) -> None:
        """Simulate the experiment.

        Args:
            seed: of the study; the experiment and each run are drawn from it.
            runs: searches in each row.
            noise_deg: on the measured angle; the thesis has none.
        """
        data = study_data()
        self.seeds = np.random.SeedSequence(seed)
        self.runs = runs
        joint = int(data["joint"]) - 1
        experiment = simulated_experiment(np.random.default_rng(self.seeds.spawn(1)[0]), noise_deg)
        self.model = MechanicalModel(experiment.command, experiment.sample, (joint,))
        self.measured = experiment.angles_deg[:, [joint]]
        self.exact = self.model(mechanical_parameters().true)

    def sweep(self) -> Iterator[Run]:
        """All rows of Tables 4.2 to 4.7."""
        data = study_data()
        budget = int(data["sweep_budget"])
        for row, changes in data["simple"].items():
            yield from self._row(row, "ga", changes, budget)
        for row, changes in data["multi_objective"].items():
            yield from self._row(row, "nsga2", {"segments": data["segments"], **changes}, budget)

    def comparison(self) -> Iterator[Run]:
        """Every method at equal budgets: a shorter budget is the beginning of the longest run."""
        data = study_data()
        budgets = [int(budget) for budget in data["comparison_budgets"]]
        for method in METHODS:
            changes: dict[str, Any] = {} if method == "ga" else {"p": 2}
            if method == "nsga2":
                changes = {"segments": data["segments"], "mutation_rate": 0.2}  # section 4.5.5
            yield from self._compared(method, method, changes, budgets)
        yield from self._compared("nsga2, logarithmic scale", "nsga2", recommended(), budgets)

    def _compared(self, row: str, method: str, changes: dict[str, Any], budgets: list[int]) -> Iterator[Run]:
        for seed in self.seeds.spawn(self.runs):
            result = self._search(method, changes, max(budgets), seed)
            for budget in budgets:
                yield self._run(row, method, cut(result, budget, changes.get("scale", "linear")), budget)

    def _row(self, row: str, method: str, changes: dict[str, Any], budget: int) -> Iterator[Run]:
        for seed in self.seeds.spawn(self.runs):
            result = self._search(method, changes, budget, seed)
            yield self._run(row, method, cut(result, budget, changes.get("scale", "linear")), budget)

    def _search(
        self, method: str, changes: dict[str, Any], budget: int, seed: np.random.SeedSequence
    ) -> SearchResult:
        parameters = mechanical_parameters()
        scale = changes.get("scale", "linear")
        objective = OutputError(
            _Scaled(self.model, scale),
            self.measured,
            p=float(changes.get("p", math.inf)),
            relative=bool(changes.get("relative", False)),
            segments=changes.get("segments"),
        )
        settings: GeneticSettings = replace(
            SIMPLE, **{key: value for key, value in changes.items() if key not in OF_OBJECTIVE}
        )
        rng = np.random.default_rng(seed)
        lower, upper = (SCALES[scale][0](bound) for bound in (parameters.lower, parameters.upper))
        return search(method, objective, lower, upper, budget, rng, settings=settings)

    def _run(self, row: str, method: str, result: SearchResult, budget: int) -> Run:
        error = self.exact - self.model(result.point)
        return Run(
            row=row,
            method=method,
            budget=budget,
            estimate=result.point,
            relative_errors=mechanical_parameters().relative_errors(result.point),
            output_error=float(np.abs(error).max()),
            mean_squared_error=float(np.mean(error**2)),
            learning=result.learning_curve,
        )


def cut(result: SearchResult, budget: int, scale: str = "linear") -> SearchResult:
    """What the search would have given with a smaller budget: its steps do not depend on the budget.

    Args:
        result: of the search.
        budget: evaluations that count.
        scale: one of `SCALES`, on which the search was made. The point of what is returned is linear: the mean of the
            best of each segment (section 4.3.4) is taken of the parameters themselves.
    """
    if budget >= result.evaluations and scale == "linear":
        return result
    parameters = mechanical_parameters()
    there, back = SCALES[scale]
    lower, upper = there(parameters.lower), there(parameters.upper)
    units, scores = result.units[:budget], result.scores[:budget]
    points = back(lower + units * (upper - lower))
    if result.method == "nsga2":
        point = pareto_set(points, scores).average
    else:
        point = points[int(np.argmin(scores.mean(axis=1)))]
    return replace(result, point=point, units=units, scores=scores)


def run_study(seed: int, runs: int, report: Callable[[str], None]) -> dict[str, list[Run]]:
    """Sweep, comparison without noise, and comparison with the potentiometer's noise (least squares only).

    Args:
        seed: of everything random.
        runs: searches in each row.
        report: told each finished row.
    """
    study = Study(seed, runs)
    found: dict[str, list[Run]] = {"sweep": [], "comparison": [], "noisy": []}
    for name, source in (("sweep", study.sweep()), ("comparison", study.comparison())):
        for run in source:
            if not found[name] or found[name][-1].row != run.row:
                report(f"{name}: {run.row}")
            found[name].append(run)
    noisy = Study(seed, runs, float(mechanical_data()["experiment"]["noise"]["value"]))
    report("noisy: least-squares")
    budget = int(study_data()["comparison_budgets"][0])
    found["noisy"] = list(noisy._row("least-squares", "least-squares", {"p": 2}, budget))
    return found
