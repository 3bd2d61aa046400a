"""A search space of chromosomes, as a pymoo problem."""

from typing import Any

import numpy as np
from pymoo.core.problem import Problem
from pymoo.core.sampling import Sampling

from hydrolek_drake.identification.search.evaluation import Evaluator
from hydrolek_drake.identification.search.genetic.coding import Coding


class CodedProblem(Problem):
    """Decodes chromosomes and evaluates those that are new; a copy of a known one costs nothing."""

    def __init__(self, coding: Coding, evaluator: Evaluator) -> None:
        """Search through `evaluator` with chromosomes of `coding`."""
        super().__init__(n_var=coding.elements, n_obj=evaluator.size, xl=0, xu=coding.highest, vtype=int)
        self.coding = coding
        self.evaluator = evaluator
        self.known: dict[bytes, np.ndarray] = {}

    def _evaluate(self, X: Any, out: Any, *args: Any, **kwargs: Any) -> None:
        keys = [np.asarray(x, dtype=np.int32).tobytes() for x in X]
        new = {key: row for row, key in enumerate(keys) if key not in self.known}
        if new:
            values = self.evaluator.values(self.coding.decode(X[list(new.values())]))
            self.known.update(zip(new, values, strict=True))
        out["F"] = np.array([self.known[key] for key in keys])


class UniformSampling(Sampling):
    """Chromosomes that are uniform in the search space."""

    def __init__(self, coding: Coding, first: np.ndarray | None) -> None:
        """Draw from `coding`; `first` are places in the unit cube that are to be among them."""
        super().__init__()
        self.coding = coding
        self.first = first

    def _do(self, problem: Any, n_samples: int, *args: Any, random_state: Any = None, **kwargs: Any) -> Any:
        drawn = random_state.integers(self.coding.highest + 1, size=(n_samples, self.coding.elements))
        if self.first is not None:
            given = self.coding.encode(self.first)[:n_samples]
            drawn[: len(given)] = given
        return drawn
