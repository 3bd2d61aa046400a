"""Mutation of single elements, as a pymoo operator."""

from typing import Any

import numpy as np
from pymoo.core.mutation import Mutation


class ElementMutation(Mutation):
    """Gives elements another random value: a bit is flipped, an integer drawn anew."""

    def __init__(self, rate: float, of: str, highest: int) -> None:
        """Prepare.

        Args:
            rate: P_m.
            of: "chromosome": one element in each mutated chromosome; "element": each by itself.
            highest: largest value of an element.
        """
        super().__init__()
        self.rate = rate
        self.of = of
        self.highest = highest

    def _do(self, problem: Any, X: Any, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
        count, elements = X.shape
        if self.of == "element":
            chosen = random_state.random(X.shape) < self.rate
        else:
            chosen = np.zeros(X.shape, dtype=bool)
            mutated = np.flatnonzero(random_state.random(count) < self.rate)
            chosen[mutated, random_state.integers(elements, size=mutated.size)] = True
        shift = random_state.integers(1, self.highest + 1, size=X.shape)  # never 0: always another value
        return np.where(chosen, (X + shift) % (self.highest + 1), X)
