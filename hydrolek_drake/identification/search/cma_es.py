"""Covariance matrix adaptation evolution strategy (Hansen, 2016), the package `cma`, with restarts."""

import warnings

import numpy as np

from hydrolek_drake.identification.search.evaluation import Evaluator

FIRST_SPREAD = 0.3
"""Standard deviation at the start, of a unit range: the usual choice, a third of it."""


def run_cma_es(evaluator: Evaluator, rng: np.random.Generator, first: np.ndarray | None = None) -> None:
    """Search until the budget is spent (`BudgetSpent`); each restart doubles the population (IPOP).

    Args:
        evaluator: of one objective.
        rng: gives seeds and starts.
        first: where the first run begins; the middle of the cube without. # (k, d)
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # cma warns of optional packages for plots
        import cma

    start = np.full(evaluator.dimension, 0.5) if first is None else first[0]
    population = 4 + int(3 * np.log(evaluator.dimension))
    while True:
        options = {
            "bounds": [0.0, 1.0],
            "popsize": population,
            "seed": int(rng.integers(1, 2**31)),
            "verbose": -9,
            "maxfevals": np.inf,
        }
        strategy = cma.CMAEvolutionStrategy(np.clip(start, 0.01, 0.99), FIRST_SPREAD, options)
        while not strategy.stop():
            asked = strategy.ask()
            strategy.tell(asked, evaluator.values(np.clip(np.array(asked), 0.0, 1.0))[:, 0])
        start = rng.uniform(size=evaluator.dimension)
        population *= 2
