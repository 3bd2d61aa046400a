"""What a search has tried so far."""

from dataclasses import dataclass, field, replace

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.gains import cost_of
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.score import Score
from hydrolek_drake.diagnosis.workbench import Hypothesis


@dataclass
class Search:
    """What was tried.

    Attributes:
        hypotheses: every set of effects that was fitted with the rig's own step, by its key.
        scores: of the effects against the fitted nominal model.
        left: gains of the effects that the best model has not.
        rounds: how many times models with one effect more were fitted.
        extended: models to which one effect more was added, with the squared residuals that they left then.
        given_up: sets of effects that were too far behind after a few steps.
        smooth: whether a fit that was led on proved not to have been stuck.
        weighed_at: what the model left, over the noise, by which the data are weighed.
        law: beside the nominal model, which explains everything and ends the search: at once if it is of the machine,
            once two effects have been tried if it is the recordings' own; None for none.
        repeated: whether effects were tried once more beside a model that they had led elsewhere.
    """

    hypotheses: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    scores: list[Score] = field(default_factory=list)
    left: list[Score] = field(default_factory=list)
    rounds: int = 0
    extended: dict[frozenset[str], float] = field(default_factory=dict)
    given_up: dict[frozenset[str], Hypothesis] = field(default_factory=dict)
    smooth: bool = False
    weighed_at: float = 0.0
    law: FoundLaw | None = None
    repeated: bool = False

    def keep(self, hypothesis: Hypothesis) -> None:
        """Remember it if it is the best fit of these effects."""
        known = self.hypotheses.get(hypothesis.ids)
        if known is None or hypothesis.fit.objective < known.fit.objective:
            self.hypotheses[hypothesis.ids] = hypothesis

    def forget(self, wide: Candidate) -> None:
        """Drop what was fitted with a narrower range of an effect."""
        for known in (self.hypotheses, self.given_up):
            for key in [key for key in known if wide.size_path in key]:
                del known[key]
        for scores in (self.scores, self.left):
            scores[:] = [
                replace(s, candidate=wide) if s.candidate.size_path == wide.size_path else s for s in scores
            ]

    @property
    def baseline(self) -> Hypothesis:
        """The nominal model, fitted."""
        return self.hypotheses[frozenset()]

    @property
    def best(self) -> Hypothesis:
        """Best fit to the training data with each effect's parameters charged for."""
        return min(self.hypotheses.values(), key=cost_of)
