"""A law before further effects: what would explain the data otherwise is asked for while a search goes on.

One effect does not do: a sine at one of the machine's inputs, such as a pump's ripple or a shaken load, or a constant
at one that says how the machine is built, such as a card's ramp. Both take a few seconds to look for. No effect of the
list repeats itself in time, so that two of them can only make up for a sine; a constant has one parameter, and two
effects have two at least.
Two do not do: any law, and then commands that got lost, which have numbers for every time that it happens and take
minutes to fit. Three effects at once are less likely than one thing that is in no list (`law_choice.MANY`).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from hydrolek_drake.diagnosis.attempt import PREDICTED, predicting
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, NEAR
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_at_a_joint import followed_worst, left_at, one_joint
from hydrolek_drake.diagnosis.law_by_both import law_by_both
from hydrolek_drake.diagnosis.law_fit import glance
from hydrolek_drake.diagnosis.law_naming import ahead_to_beat
from hydrolek_drake.diagnosis.law_problem import FoundLaw, Law
from hydrolek_drake.diagnosis.law_scan import STEADY
from hydrolek_drake.diagnosis.law_search import promising
from hydrolek_drake.diagnosis.law_told_anew import told_anew
from hydrolek_drake.diagnosis.laws import BUILT, TERMS
from hydrolek_drake.diagnosis.unlisted import Asked, best_of
from hydrolek_drake.diagnosis.weighing import weighted_by
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment

MOST = 0.5
"""Before a second effect a law must promise this share of what the nominal model leaves above the noise, or it is not
fitted."""

MOST_LOST = 0.25
"""So much windows without a command must promise together. They are picked by first order, beside a nominal model that
has bent its numbers, and hold far more or nothing once they are fitted."""

HOPEFUL, GLANCED = 0.05, 2
"""A nominal model that has bent its numbers far lets a constant promise little. The first few that promise this share
are fitted with a few steps, and on if that explains what it sees."""


SLACK = 1.15
"""A law at one of several joints, and the others without it, may leave so many times more than what explains them, as
long as what the joints do to each other is told without the law."""


@dataclass(frozen=True)
class OtherLaws:
    """What is asked beside a search.

    Attributes:
        bench: training data and fits.
        held_out: what decides.
        scales: natural scales of the driven joints at which there may be a law, one at least.
        apart: whether the held-out data are of another kind, not blocks among the rest.
    """

    bench: Workbench
    held_out: Sequence[Experiment]
    scales: Mapping[str, Scales]
    apart: bool = False

    def __call__(self, nominal: Hypothesis, effects: int) -> FoundLaw | None:
        """The law of the machine that explains both recordings, or None.

        Args:
            nominal: the model without effects.
            effects: how many of them do not explain the training data.
        """
        return self._asked(
            nominal, partial(_asked_for, effects=effects, apart=self.apart and not self._several)
        )

    def lost(self, nominal: Hypothesis) -> FoundLaw | None:
        """Commands that got lost, if that explains both recordings, or None.

        Args:
            nominal: the model without effects.
        """
        return self._asked(nominal, _lost)

    @property
    def _several(self) -> bool:
        return len({experiment.joint for experiment in self.held_out}) > 1

    def _asked(self, nominal: Hypothesis, question: "_Question") -> FoundLaw | None:
        """What is asked of the only joint, or of the one that is followed worst."""
        bench = self.bench
        weighted = bench.with_training(weighted_by(bench, nominal, bench.training))
        weighted.first_s = bench.first_s
        left = weighted.refit(nominal, bench.fine, 1)
        held_out = weighted_by(bench, nominal, self.held_out)
        if self._several:
            law = _at_one_joint(weighted, left, held_out, self.scales, question)
        else:
            law = question(weighted, left, held_out, next(iter(self.scales.values())), 1.0)
        bench.evaluations += weighted.evaluations
        return law


_Question = Callable[[Workbench, Hypothesis, Sequence[Experiment], Scales, float], FoundLaw | None]
"""Training data and fits, the model that leaves something, held-out data, scales of the joint, slack."""


def _asked_for(
    bench: Workbench,
    left: Hypothesis,
    held_out: Sequence[Experiment],
    scales: Scales,
    slack: float,
    *,
    effects: int,
    apart: bool = False,
) -> FoundLaw | None:
    """The law at the only joint of some data that explains them, or None."""
    asked = Asked.of(bench, left, held_out, scales)
    first = effects == 1
    laws = promising(bench, left, asked.inputs, asked.span, asked.step, BUILT if first else TERMS)
    if first:
        above = left.fit.objective - left.fit.counted
        laws = [*worth_it(laws, MOST * above), *_better_than_promised(bench, asked, laws, above)]
    counted = sum(experiment.counted for experiment in held_out)
    ahead = Judged(left, bench.residuals(left, held_out, bench.fine), counted)
    law = best_of(bench, asked, laws, ahead_to_beat(ahead.over_noise))
    if law is not None and apart:
        law = law_by_both(bench, left, law, held_out) or law
    return law if law is not None and predicting(law, slack) and _explaining(law, slack) else None


def _explaining(law: FoundLaw, slack: float = 1.0) -> bool:
    """Whether a law leaves so little of the training data that nothing more is asked."""
    return law.law.periodic or law.fit.over_noise <= slack * ABOVE_NOISE


def _lost(
    bench: Workbench, left: Hypothesis, held_out: Sequence[Experiment], scales: Scales, slack: float
) -> FoundLaw | None:
    """Commands that got lost, if that explains the data: windows could make up for a little of much."""
    if left.fit.over_noise <= NEAR:
        return None
    return None


def _better_than_promised(bench: Workbench, asked: Asked, laws: Sequence[Law], above: float) -> list[Law]:
    """Constants that promise too little to be fitted, and explain the beginning of the data by a few steps."""
    hopeful = [law for law in laws if _built(law) and HOPEFUL * above < law.gain <= MOST * above]
    tried = sorted(hopeful, key=lambda law: -law.gain)[:GLANCED]
    if not tried:
        return []
    begun = bench.side_by_side(lambda law: glance(bench, asked.left, law, asked.span, asked.step), tried)
    most = EXPLAINED**2 * sum(experiment.counted for experiment in bench.beginning())
    return [law for law, (objective, *_) in zip(tried, begun, strict=True) if objective < most]


def _at_one_joint(
    bench: Workbench,
    left: Hypothesis,
    held_out: Sequence[Experiment],
    scales: Mapping[str, Scales],
    question: _Question,
) -> FoundLaw | None:
    """The law at the joint that is followed worst that explains its data, if the others' are explained without."""
    ahead = bench.residuals(left, held_out, bench.fine)
    joint = followed_worst(ahead, held_out, scales)
    if joint is None or not _others_explained(
        joint, (left.fit.residuals, bench.training), (ahead, held_out), SLACK
    ):
        return None
    one = one_joint(bench, left, held_out, joint, scales[joint])
    found = question(one.bench, one.nominal, one.held_out, one.scales, SLACK)
    bench.evaluations += one.bench.evaluations
    if found is None:
        return None
    told = told_anew(bench, left, one.whole(found), held_out)
    beside = [
        bench.residuals(left, experiments, bench.fine) for experiments in (told.training, told.held_out)
    ]
    others = _others_explained(joint, (beside[0], told.training), (beside[1], told.held_out))
    return told.law if others and predicting(told.law) and _explaining(told.law) else None


def _others_explained(
    joint: str,
    training: tuple[np.ndarray, Sequence[Experiment]],
    held_out: tuple[np.ndarray, Sequence[Experiment]],
    slack: float = 1.0,
) -> bool:
    """Whether a model explains all joints but one.

    Args:
        joint: that one.
        training: residuals and data.
        held_out: the same of the data that decide.
        slack: so many times what a right model may leave.
    """
    for (residuals, experiments), most in ((training, EXPLAINED), (held_out, PREDICTED)):
        squares, counted = left_at(joint, residuals, experiments)
        rest = sum(experiment.counted for experiment in experiments) - counted
        if float(residuals @ residuals) - squares > (slack * most) ** 2 * rest:
            return False
    return True


def worth_it(laws: Sequence[Law], needed: float) -> list[Law]:
    """Those that are fitted before a second effect.

    All sines, if one promises what is needed, and the constants that do, at inputs that say how the machine is built.
    """
    sines = [law for law in laws if law.periodic]
    built = [law for law in laws if _built(law) and law.gain > needed]
    return [*(sines if any(law.gain > needed for law in sines) else ()), *built]


def _built(law: Law) -> bool:
    """Whether it is a constant that says how the machine is built."""
    return not law.periodic and law.input.probe in STEADY
