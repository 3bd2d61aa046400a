"""A law that explains the training data and goes astray ahead, fitted to parts of both recordings.

Some numbers of the machine show in the held-out recording alone, such as what opens a valve under the weight of an arm
that the training data hold elsewhere. A right law beside wrong numbers goes astray there; fitted to parts of both it
explains both, which what only imitates it hardly does. Of effects the same is asked (`again.by_both_as_found`).
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.attempt import Known, attempted, predicting, whole
from hydrolek_drake.diagnosis.conclusion import EXPLAINED
from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, LOOK
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.law_fit import fitted
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.splitting import mixed
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment


def law_by_both(
    bench: Workbench, left: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment]
) -> FoundLaw | None:
    """The law fitted to parts of both recordings; None where it does not go astray, or does not explain both.

    A periodic one has a phase in every recording, and what is the recordings' own is no law of the machine.

    Args:
        bench: training data of one joint.
        left: the model that the law is added to.
        law: fitted to the training data.
        held_out: another recording.
    """
    astray = law.fit.over_noise <= EXPLAINED and not predicting(law)
    if not astray or law.law.periodic or not law.of_the_machine:
        return None
    training, kept = mixed(bench.training, held_out)
    again = bench.with_training(training)
    begin = (law.parameters, law.values)
    both = fitted(again, left, law.law, kept, law.span, begin, again.fine, 2 * LOOK, valleys=True)
    bench.evaluations += again.evaluations
    if both.fit.over_noise > ABOVE_NOISE or not predicting(both):
        return None
    return replace(both, rivals=law.rivals, parts=(training, kept))


def known_by_both(known: Known, law: FoundLaw, say: Callable[[str], None]) -> Known:
    """What was tried before a law, fitted to the same parts of both recordings as the law and held against the rest.

    Args:
        known: by the training data.
        law: see `law_by_both`.
        say: told what is being done.

    Raises:
        KeyboardInterrupt: it was interrupted.
    """
    assert law.parts is not None
    training, kept = law.parts
    again = known.bench.with_training(training)
    found = Search(scores=known.found.scores, left=known.found.left, law=law)

    def fit_again() -> None:
        tried = [judged.hypothesis for judged in known.judged]
        for hypothesis in again.side_by_side(lambda h: again.refit(h, again.fine, LOOK, alone=True), tried):
            found.keep(hypothesis)
        found.weighed_at = found.baseline.fit.over_noise

    return whole(attempted(again, found, fit_again, kept, say))
