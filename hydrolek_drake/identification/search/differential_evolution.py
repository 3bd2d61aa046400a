"""Differential evolution (Storn and Price, 1997), scipy's implementation."""

import numpy as np
from scipy.optimize import differential_evolution

from hydrolek_drake.identification.search.evaluation import Evaluator


def run_differential_evolution(
    evaluator: Evaluator, rng: np.random.Generator, first: np.ndarray | None = None, members: int = 5
) -> None:
    """Search until the budget is spent (`BudgetSpent`) or the population has converged.

    Args:
        evaluator: of one objective.
        rng: random numbers.
        first: places to begin with; the best-first one is made a member. # (k, d)
        members: of the population for each parameter.
    """

    def values(columns: np.ndarray) -> np.ndarray:
        units = np.atleast_2d(columns.T)
        return evaluator.values(units)[:, 0]

    differential_evolution(
        values,
        [(0.0, 1.0)] * evaluator.dimension,
        rng=rng,
        popsize=members,
        maxiter=evaluator.budget,
        tol=0.0,
        atol=0.0,
        init="latinhypercube",
        x0=None if first is None else first[0],
        polish=False,
        updating="deferred",
        vectorized=True,
    )
