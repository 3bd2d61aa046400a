"""What a structure costs, and what a search has tried, the best by that cost."""

import math
from dataclasses import dataclass, field

from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.workbench import Hypothesis
from hydrolek_drake.identification.least_squares import Fit


def cost(structure: Hypothesis) -> float:
    """Twice the negative log-likelihood of the training data, and what its additions and their parameters cost."""
    additions = sum(c.cost for c in structure.effects)
    return misfit(structure.fit) + gain_needed(structure.fit) * additions + 2.0 * structure.extra


def misfit(fit: Fit) -> float:
    """Twice the negative log-likelihood of what a fit leaves, with the discrepancy of its model as a parameter.

    A model that is right leaves squares as many as there are values, n; one that leaves s n has a discrepancy, whose
    variance, as large as it is most likely, makes that n (1 + log s) (profile likelihood). What takes a share of a
    misfit then counts by that share, and near the noise by its squares.
    """
    share = fit.objective / max(fit.counted, 1)
    return fit.counted * (1.0 + math.log(share)) if share > 1.0 else fit.objective


@dataclass
class Tried(Search):
    """What was tried, with costs that hold however far structures are from the noise.

    Attributes:
        costs: of the best structure after each round.
        seeds: structures fitted to other data, from where fits begin too.
    """

    costs: list[float] = field(default_factory=list)
    seeds: list[Hypothesis] = field(default_factory=list)

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of these additions."""
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis

    @property
    def best(self) -> Hypothesis:
        """The structure that costs least."""
        return min(self.hypotheses.values(), key=cost)

    def rounds_without_gain(self, patience: int) -> bool:
        """Whether so many rounds have not changed which structure is best, to within a unit of log-odds."""
        self.costs.append(cost(self.best))
        return len(self.costs) > patience and self.costs[-1] > self.costs[-1 - patience] - 2.0
