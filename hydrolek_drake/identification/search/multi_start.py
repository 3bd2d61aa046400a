"""Bounded least squares from many starts, within a budget of evaluations."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from hydrolek_drake.identification.search.evaluation import FAILED, BudgetSpent, Evaluator

DIFFERENCE = 1e-6
"""Step of the forward differences as a part of the range."""

EDGE = 1e-6
"""Starts keep this distance from the ends, where the trust region would have no room."""

WITHOUT_VALUE = 1e3
"""Residual where a simulation diverged."""


def run_multi_start(
    evaluator: Evaluator,
    residuals: Callable[[np.ndarray], np.ndarray],
    rng: np.random.Generator,
    first: np.ndarray | None = None,
    loss: str = "linear",
    candidates: int = 10,
) -> None:
    """Fit from the best of some random places, again and again, until the budget is spent (`BudgetSpent`).

    Args:
        evaluator: counts and remembers; its objective scores the residuals.
        residuals: point -> residuals, NaN after a divergence.
        rng: draws the starts.
        first: starts to be tried before random ones. # (k, d)
        loss: scipy's robust loss.
        candidates: random places of which the best becomes a start.
    """

    def evaluated(unit: np.ndarray) -> np.ndarray:
        if evaluator.left <= 0:
            raise BudgetSpent
        found = np.ravel(residuals(evaluator.point(unit)))
        score = evaluator.objective.score(found) if np.isfinite(found).all() else np.array([FAILED])
        evaluator.note(unit, score)
        return np.clip(np.nan_to_num(found, nan=WITHOUT_VALUE), -WITHOUT_VALUE, WITHOUT_VALUE)

    def jacobian(unit: np.ndarray) -> np.ndarray:
        base = latest[unit.tobytes()]
        columns = []
        for i in range(len(unit)):
            step = DIFFERENCE if unit[i] + DIFFERENCE <= 1.0 else -DIFFERENCE
            moved = unit.copy()
            moved[i] += step
            columns.append((evaluated(moved) - base) / step)
        return np.stack(columns, axis=1)

    latest: dict[bytes, np.ndarray] = {}

    def remembered(unit: np.ndarray) -> np.ndarray:
        value = evaluated(unit)
        latest.clear()
        latest[unit.tobytes()] = value
        return value

    waiting = [] if first is None else list(first)
    while True:
        if waiting:
            start = np.asarray(waiting.pop(0), dtype=float)
        else:
            places = rng.uniform(size=(candidates, evaluator.dimension))
            costs = [float(np.sum(evaluated(place) ** 2)) for place in places]
            start = places[int(np.argmin(costs))]
        inside = np.clip(start, EDGE, 1.0 - EDGE)
        least_squares(
            remembered, inside, jac=jacobian, bounds=(0.0, 1.0), loss=loss, xtol=1e-12, ftol=1e-12, gtol=1e-12
        )
