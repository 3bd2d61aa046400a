"""The multi-objective genetic algorithm of section 4.4.2: NSGA-II over the segments of a recording."""

from dataclasses import dataclass

import numpy as np
from pymoo.algorithms.moo.nsga2 import NSGA2
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

from hydrolek_drake.identification.search.evaluation import Evaluator
from hydrolek_drake.identification.search.genetic.coded_problem import CodedProblem
from hydrolek_drake.identification.search.genetic.coding import coding_for
from hydrolek_drake.identification.search.genetic.settings import GeneticSettings
from hydrolek_drake.identification.search.genetic.simple import breed, operators


@dataclass(frozen=True)
class ParetoSet:
    """The compromises that were found (section 4.3.4).

    Attributes:
        points: no other is better in every segment. # (k, parameters)
        values: norm (4.18) of each segment. # (k, segments)
    """

    points: np.ndarray
    values: np.ndarray

    @property
    def best_per_segment(self) -> np.ndarray:
        """The solution with the least norm in each segment. # (segments, parameters)."""
        return self.points[np.argmin(self.values, axis=0)]

    @property
    def average(self) -> np.ndarray:
        """Mean of the best of each segment: the thesis's final solution. # (parameters,)."""
        return self.best_per_segment.mean(axis=0)


def run_multi_objective(
    evaluator: Evaluator, settings: GeneticSettings, rng: np.random.Generator, first: np.ndarray | None = None
) -> None:
    """Search with NSGA-II until the evaluator's budget is spent (it raises `BudgetSpent`).

    Args:
        evaluator: of one objective a segment.
        settings: coding, operators and rates.
        rng: gives the seed.
        first: places in the unit cube to begin with, besides random ones. # (k, parameters)
    """
    coding = coding_for(settings, evaluator.dimension)
    algorithm = NSGA2(**operators(coding, settings, first), eliminate_duplicates=False)
    breed(algorithm, CodedProblem(coding, evaluator), rng)


def pareto_set(points: np.ndarray, values: np.ndarray) -> ParetoSet:
    """The first front of everything that was evaluated.

    Args:
        points: # (k, parameters)
        values: # (k, segments)
    """
    front = NonDominatedSorting().do(values, only_non_dominated_front=True)
    return ParetoSet(points[front], values[front])
