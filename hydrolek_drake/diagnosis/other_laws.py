"""A law before further effects: what would explain the data otherwise is asked for while a search goes on.

One effect does not do: a sine at one of the machine's inputs, such as a pump's ripple or a shaken load. It takes a few
seconds to look for, and no effect of the list repeats itself in time, so that two of them can only make up for it.
Two do not do: any law. Three effects at once are less likely than one thing that is in no list (`law_choice.MANY`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.attempt import predicting
from hydrolek_drake.diagnosis.effort import AT_NOISE
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.laws import TERMS
from hydrolek_drake.diagnosis.unlisted import BETTER, Asked, best_of
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

MOST = 0.5
"""A sine must promise this share of what the nominal model leaves above the noise, or it is not fitted."""


@dataclass(frozen=True)
class OtherLaws:
    """What is asked beside a search.

    Attributes:
        bench: training data and fits.
        held_out: what decides.
        scales: natural scales of the joint.
    """

    bench: Workbench
    held_out: Sequence[Experiment]
    scales: Scales

    def __call__(self, nominal: Hypothesis, effects: int) -> FoundLaw | None:
        """The law that explains both recordings, or None.

        Args:
            nominal: the model without effects.
            effects: how many of them do not explain the training data.
        """
        bench = self.bench
        weighted = bench.with_training(weighted_by(bench, nominal, bench.training))
        weighted.first_s = bench.first_s
        left = weighted.refit(nominal, bench.fine, 1)
        asked = Asked.of(weighted, left, weighted_by(bench, nominal, self.held_out), self.scales)
        sines_alone = effects == 1
        terms = () if sines_alone else TERMS
        laws = promising(weighted, left, asked.inputs, asked.span, asked.step, terms)
        law = None
        if not sines_alone or max(each.gain for each in laws) > MOST * (
            left.fit.objective - left.fit.counted
        ):
            law = best_of(weighted, asked, laws, BETTER * left.fit.over_noise)
        bench.evaluations += weighted.evaluations
        if law is None or not predicting(law):
            return None
        return law if sines_alone or law.fit.over_noise <= AT_NOISE else None
