"""What a search has tried, the best by its cost."""

from dataclasses import dataclass, field

from hydrolek_drake.diagnosis.fitting.promise import Promise
from hydrolek_drake.diagnosis.settings import GAINS, Settings
from hydrolek_drake.diagnosis.structures.cost import cost
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis


@dataclass
class Tried:
    """What was tried, with costs that hold however far structures are from the noise.

    Attributes:
        hypotheses: every structure that was fitted with the rig's own step, by its key.
        left: what effects promise that the structure which was enlarged last has not.
        given_up: structures that were not fitted again when the data were weighed anew.
        weighed_at: what the structure left, over the noise, by which the data are weighed.
        costs: of the best structure after each round.
        seeds: structures fitted to other data, from where fits begin too.
        lessened: the structure that was fitted without each of its additions last.
    """

    hypotheses: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    left: list[Promise] = field(default_factory=list)
    given_up: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    weighed_at: float = 0.0
    costs: list[float] = field(default_factory=list)
    seeds: list[Hypothesis] = field(default_factory=list)
    lessened: Hypothesis | None = None

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of its structure, and all that it adds makes a difference in practice."""
        if not all(c.says_something(hypothesis.values) for c in hypothesis.effects):
            return
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis

    @property
    def baseline(self) -> Hypothesis:
        """The nominal model, fitted."""
        return self.hypotheses[frozenset()]

    @property
    def best(self) -> Hypothesis:
        """The structure that costs least."""
        return min(self.hypotheses.values(), key=cost)

    def near_the_best(self, settings: Settings) -> list[Hypothesis]:
        """Those near the best one, the best first, and all that it contains: others lie behind for good.

        Args:
            settings: of the search.
        """
        best = self.best
        ranked = sorted(self.hypotheses.values(), key=lambda h: h.fit.objective)
        within = settings.again_within**2 * best.fit.objective
        near = [h for h in ranked if h.fit.objective < within][: settings.most_again]
        return list({h.ids: h for h in [*near, *(h for h in ranked if h.ids <= best.ids)]}.values())

    @property
    def gaining(self) -> bool:
        """Whether the last round led to a better structure than the one before it."""
        return len(self.costs) < 2 or self.costs[-1] <= self.costs[-2] - GAINS.told_apart

    def rounds_without_gain(self, patience: int) -> bool:
        """Whether so many rounds have not changed which structure is best, to within a unit of log-odds."""
        self.costs.append(cost(self.best))
        return len(self.costs) > patience and self.costs[-1] > self.costs[-1 - patience] - GAINS.told_apart
