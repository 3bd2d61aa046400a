"""A law before further effects: what would explain the data otherwise is asked for while a search goes on.

One effect does not do: a sine at one of the machine's inputs, such as a pump's ripple or a shaken load, or a constant
at one that says how the machine is built, such as a card's ramp. Both take a few seconds to look for. No effect of the
list repeats itself in time, so that two of them can only make up for a sine; a constant has one parameter, and two
effects have two at least.
Two do not do: any law. Three effects at once are less likely than one thing that is in no list (`law_choice.MANY`).
"""

from collections.abc import Sequence
from dataclasses import dataclass

from hydrolek_drake.diagnosis.attempt import predicting
from hydrolek_drake.diagnosis.effort import AT_NOISE
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.law_search import STEADY, promising
from hydrolek_drake.diagnosis.laws import BUILT, TERMS
from hydrolek_drake.diagnosis.unlisted import BETTER, Asked, best_of
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

MOST = 0.5
"""Before a second effect a law must promise this share of what the nominal model leaves above the noise, or it is not
fitted."""


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
        first = effects == 1
        laws = promising(weighted, left, asked.inputs, asked.span, asked.step, BUILT if first else TERMS)
        if first:
            laws = worth_it(laws, MOST * (left.fit.objective - left.fit.counted))
        law = best_of(weighted, asked, laws, BETTER * left.fit.over_noise)
        bench.evaluations += weighted.evaluations
        if law is None or not predicting(law):
            return None
        return law if law.law.periodic or law.fit.over_noise <= AT_NOISE else None


def worth_it(laws: Sequence[Law], needed: float) -> list[Law]:
    """Those that are fitted before a second effect.

    All sines, if one promises what is needed, and the constants that do, at inputs that say how the machine is built.
    """
    sines = [law for law in laws if law.periodic]
    built = [law for law in laws if not law.periodic and law.input.probe in STEADY and law.gain > needed]
    return [*(sines if any(law.gain > needed for law in sines) else ()), *built]
