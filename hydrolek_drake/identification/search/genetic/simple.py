"""The simple genetic algorithm of section 4.4.1 and figure 4.12."""

from typing import Any

import numpy as np
from pymoo.algorithms.base.genetic import GeneticAlgorithm
from pymoo.core.population import Population
from pymoo.core.termination import NoTermination

from hydrolek_drake.identification.search.evaluation import Evaluator
from hydrolek_drake.identification.search.genetic.coded_problem import CodedProblem, UniformSampling
from hydrolek_drake.identification.search.genetic.coding import Coding, coding_for
from hydrolek_drake.identification.search.genetic.crossover import crossover_for
from hydrolek_drake.identification.search.genetic.mutation import ElementMutation
from hydrolek_drake.identification.search.genetic.selection import RouletteSelection
from hydrolek_drake.identification.search.genetic.settings import GeneticSettings

STANDING_STILL = 200
"""Generations without any new chromosome after which a search has died out."""


class SimpleGeneticAlgorithm(GeneticAlgorithm):
    """Each generation is replaced by its children, but for the elite."""

    pop: Any

    def __init__(self, elite: int, **kwargs: Any) -> None:
        """Keep the `elite` best of each generation; the rest as pymoo's `GeneticAlgorithm`."""
        super().__init__(eliminate_duplicates=False, **kwargs)
        self.elite = elite

    def _advance(self, infills: Any = None, **kwargs: Any) -> None:
        if infills is None:
            return
        parents = self.pop
        best = np.argsort(parents.get("F")[:, 0], kind="stable")[: self.elite]
        self.pop = Population.merge(parents[best], infills[: self.pop_size - len(best)])


def run_simple(
    evaluator: Evaluator, settings: GeneticSettings, rng: np.random.Generator, first: np.ndarray | None = None
) -> None:
    """Search until the evaluator's budget is spent (it raises `BudgetSpent`) or the population is all alike.

    Args:
        evaluator: of one objective.
        settings: coding, operators and rates.
        rng: gives the seed.
        first: places in the unit cube to begin with, besides random ones. # (k, parameters)
    """
    coding = coding_for(settings, evaluator.dimension)
    algorithm = SimpleGeneticAlgorithm(elite=settings.elite, **operators(coding, settings, first))
    breed(algorithm, CodedProblem(coding, evaluator), rng)


def operators(coding: Coding, settings: GeneticSettings, first: np.ndarray | None) -> dict[str, Any]:
    """What both algorithms give to pymoo."""
    return {
        "pop_size": settings.population,
        "sampling": UniformSampling(coding, first),
        "selection": RouletteSelection(),
        "crossover": crossover_for(settings),
        "mutation": ElementMutation(settings.mutation_rate, settings.mutation, coding.highest),
    }


def breed(algorithm: Any, problem: CodedProblem, rng: np.random.Generator) -> None:
    """Generation after generation, until nothing new comes."""
    algorithm.setup(problem, termination=NoTermination(), seed=int(rng.integers(2**31)), verbose=False)
    still = 0
    while still < STANDING_STILL:
        before = len(problem.known)
        algorithm.next()
        still = 0 if len(problem.known) > before else still + 1
