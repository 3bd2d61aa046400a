"""Evaluations of an objective: counted, remembered, journalled, and never fatal."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from hydrolek_drake.identification.search.journal import Journal

FAILED = 1e30
"""Score of an evaluation that failed, diverged or took too long: worse than any other."""

Objective = Callable[[np.ndarray], np.ndarray]
Mapping = Callable[[Sequence[np.ndarray]], "list[np.ndarray | None]"]
"""Evaluates several points; None for one that failed."""


class BudgetSpent(Exception):
    """The evaluations that were allowed are used up: the regular end of a search."""


class Evaluator:
    """Objective over the unit cube.

    Attributes:
        units: places that were evaluated, in order.
        scores: what came out, FAILED for a failure.
    """

    def __init__(
        self,
        objective: Any,
        lower: np.ndarray,
        upper: np.ndarray,
        budget: int,
        *,
        size: int = 1,
        evaluate: Mapping | None = None,
        journal: Journal | None = None,
        progress: Callable[[int, float], None] | None = None,
    ) -> None:
        """Prepare.

        Args:
            objective: point (d,) -> values (size,).
            lower: ends of the box. # (d,)
            upper: # (d,)
            budget: evaluations that are allowed.
            size: how many values an evaluation gives.
            evaluate: evaluates several points, such as over processes; None for here.
            journal: keeps what was evaluated.
            progress: told after each batch how many evaluations are done and the best sum of values.
        """
        self.objective = objective
        self.lower = np.asarray(lower, dtype=float)
        self.upper = np.asarray(upper, dtype=float)
        self.budget = budget
        self.size = size
        self.units: list[np.ndarray] = []
        self.scores: list[np.ndarray] = []
        self._evaluate = evaluate or (lambda points: attempt_all(objective, points))
        self._journal = journal
        self._progress = progress
        self._best = FAILED

    @property
    def dimension(self) -> int:
        """Number of parameters."""
        return len(self.lower)

    @property
    def left(self) -> int:
        """Evaluations that are still allowed."""
        return self.budget - len(self.units)

    def point(self, unit: np.ndarray) -> np.ndarray:
        """Parameters at a place of the unit cube."""
        return self.lower + unit * (self.upper - self.lower)

    def values(self, units: np.ndarray) -> np.ndarray:
        """Evaluate places of the unit cube. # (k, d) -> (k, size).

        Raises:
            BudgetSpent: fewer evaluations are allowed than asked for; those allowed were made.
        """
        allowed = units[: max(self.left, 0)]
        new: list[np.ndarray] = [] if self._journal is None else self._journal.replayed(allowed)
        if len(new) < len(allowed):
            fresh = self._evaluate([self.point(unit) for unit in allowed[len(new) :]])
            scores = [_score(value, self.size) for value in fresh]
            if self._journal is not None:
                self._journal.append(allowed[len(new) :], scores)
            new = [*new, *scores]
        for unit, score in zip(allowed, new, strict=True):
            self.note(unit, score)
        if len(allowed) < len(units):
            raise BudgetSpent
        return np.array(new).reshape(len(units), self.size)

    def note(self, unit: np.ndarray, score: np.ndarray) -> None:
        """Remember an evaluation that was made elsewhere."""
        self.units.append(np.array(unit, dtype=float))
        self.scores.append(np.asarray(score, dtype=float))
        self._best = min(self._best, float(np.sum(score)))
        if self._progress is not None:
            self._progress(len(self.units), self._best)


def attempt(objective: Objective, point: np.ndarray) -> np.ndarray | None:
    """Value of an objective, or None if it fails: no evaluation may stop a search."""
    try:
        return np.asarray(objective(point), dtype=float)
    except Exception:
        return None


def attempt_all(objective: Any, points: Sequence[np.ndarray]) -> list[np.ndarray | None]:
    """Values at several points, None for each that failed; at once where the objective can do that (`of_all`)."""
    if len(points) > 1 and hasattr(objective, "of_all"):
        try:
            return [np.asarray(value, dtype=float) for value in objective.of_all(points)]
        except Exception:  # one of them; which, and what the others are worth, is found one by one
            pass
    return [attempt(objective, point) for point in points]


def _score(value: np.ndarray | None, size: int) -> np.ndarray:
    if value is None or value.shape != (size,):
        return np.full(size, FAILED)
    return np.where(np.isfinite(value), np.minimum(value, FAILED), FAILED)
