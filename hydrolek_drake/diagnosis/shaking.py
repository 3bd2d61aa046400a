"""A periodic disturbance, looked for before a second effect: no effect of the list repeats itself in time.

A pump's ripple or a shaken load leaves a search with one effect after the other that makes up for some of it. A sine
at one of the machine's inputs costs a few seconds to look for, and if it explains the training data and predicts the
held-out ones, nothing else is needed.
"""

from collections.abc import Sequence

from hydrolek_drake.diagnosis.attempt import predicting
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.unlisted import Asked, best_of
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

MOST = 0.5
"""A sine must promise this share of what the nominal model leaves above the noise, or it is not fitted."""


def shaken(
    bench: Workbench, nominal: Hypothesis, held_out: Sequence[Experiment], scales: Scales
) -> FoundLaw | None:
    """The periodic law that explains both recordings, or None.

    Args:
        bench: training data and fits.
        nominal: the model without effects.
        held_out: what decides.
        scales: natural scales of the joint.
    """
    weighted = bench.with_training(weighted_by(bench, nominal, bench.training))
    weighted.first_s = bench.first_s
    left = weighted.refit(nominal, bench.fine, 1)
    asked = Asked.of(weighted, left, weighted_by(bench, nominal, held_out), scales)
    sines = promising(weighted, left, asked.inputs, asked.span, asked.step, terms=())
    law = None
    if max(law.gain for law in sines) > MOST * (left.fit.objective - left.fit.counted):
        law = best_of(weighted, asked, sines, to_beat=left.fit.over_noise)
    bench.evaluations += weighted.evaluations
    return law if law is not None and predicting(law) else None
