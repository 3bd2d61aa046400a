"""Differential evolution (Storn and Price, 1997), scipy's implementation."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import differential_evolution

from hydrolek_drake.identification.search.evaluation import Evaluator


class _Stopped(Exception):
    """Carries any error through scipy, which replaces a ValueError of an objective by a message of its own."""


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
    trouble: list[Exception] = []

    def values(columns: np.ndarray) -> np.ndarray:
        try:
            return evaluator.values(np.atleast_2d(columns.T))[:, 0]
        except Exception as error:
            trouble.append(error)
            raise _Stopped from error

    try:
        _minimise(values, evaluator, rng, first, members)
    except _Stopped:
        raise trouble[0] from None


def _minimise(
    values: Callable[[np.ndarray], np.ndarray],
    evaluator: Evaluator,
    rng: np.random.Generator,
    first: np.ndarray | None,
    members: int,
) -> None:
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
