"""The two crossovers of section 4.5.1, as pymoo operators."""

from typing import Any

import numpy as np
from pymoo.core.crossover import Crossover

from hydrolek_drake.identification.search.genetic.settings import GeneticSettings


class PointwiseCrossover(Crossover):
    """Cuts both parents at the same random places and swaps every other piece."""

    def __init__(self, rate: float, points: int) -> None:
        """Cross with probability `rate` at `points` places."""
        super().__init__(2, 2, prob=rate)
        self.points = points

    def _do(self, problem: Any, X: Any, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
        _, matings, elements = X.shape
        points = min(self.points, elements - 1)
        swapped = np.zeros((matings, elements), dtype=bool)
        for row in swapped:
            for cut in random_state.choice(np.arange(1, elements), size=points, replace=False):
                row[cut:] ^= True
        return np.where(swapped, X[::-1], X)


class UniformCrossover(Crossover):
    """Swaps every other element, so that each child has half of either parent."""

    def __init__(self, rate: float) -> None:
        """Cross with probability `rate`."""
        super().__init__(2, 2, prob=rate)

    def _do(self, problem: Any, X: Any, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
        swapped = np.arange(X.shape[2]) % 2 == 1
        return np.where(swapped, X[::-1], X)


def crossover_for(settings: GeneticSettings) -> Crossover:
    """The crossover that the settings name."""
    if settings.crossover == "pointwise":
        return PointwiseCrossover(settings.crossover_rate, settings.crossover_points)
    return UniformCrossover(settings.crossover_rate)
