"""Roulette selection: parents are drawn in proportion to their fitness, with replacement."""

from typing import Any

import numpy as np
from pymoo.core.selection import Selection
from pymoo.util.nds.non_dominated_sorting import NonDominatedSorting

from hydrolek_drake.identification.search.evaluation import FAILED


class RouletteSelection(Selection):
    """The weighted roulette wheel of section 4.4.1.

    The objective is made small, so the fitness of a chromosome is how far it lies below the worst of its
    generation; one that failed has none. With several objectives it is how many fronts lie behind its own
    (the dummy fitness of Srinivas and Deb, 1994).
    """

    def _do(
        self,
        problem: Any,
        pop: Any,
        n_select: int,
        n_parents: int,
        random_state: Any = None,
        **kwargs: Any,
    ) -> Any:
        weights = fitness(pop.get("F"))
        return random_state.choice(len(pop), size=(n_select, n_parents), p=weights / weights.sum())


def fitness(values: np.ndarray) -> np.ndarray:
    """Weights on the wheel, not all zero. # (k, objectives) -> (k,)."""
    if values.shape[1] == 1:
        column = values[:, 0]
        worth = np.where(column < FAILED, column, np.nan)
        weights = np.zeros(len(column)) if np.isnan(worth).all() else np.nan_to_num(np.nanmax(worth) - worth)
    else:
        fronts = NonDominatedSorting().do(values)
        weights = np.empty(len(values))
        for number, front in enumerate(fronts):
            weights[front] = len(fronts) - number
    return weights if weights.sum() > 0.0 else np.ones(len(values))
