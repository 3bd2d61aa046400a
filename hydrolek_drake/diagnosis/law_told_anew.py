"""A law at one of several joints that move together, fitted with what they do to each other beside it.

What shakes one joint shakes the others through arm and pump, and they answer. A rollout of all joints without the law
knows nothing of that (`together`), so that a right law leaves more than noise at its own joint, and the others look as
if they lacked something. One with the law tells the movement anew; the law is fitted with that, in turn.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from hydrolek_drake.diagnosis.effort import FALLING
from hydrolek_drake.diagnosis.enlarged import enlarged_rig
from hydrolek_drake.diagnosis.law_at_a_joint import bench_at
from hydrolek_drake.diagnosis.law_fit import fitted
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.recorded_together import recordings_of

ROUNDS = 3
"""So often at most rollout and fit take turns."""


@dataclass(frozen=True)
class Told:
    """A law with the data that it belongs to.

    Attributes:
        law: fitted.
        training: of all joints, with what the joints do to each other beside the law.
        held_out: the same of the data that decide.
    """

    law: FoundLaw
    training: tuple[Experiment, ...]
    held_out: tuple[Experiment, ...]


def told_anew(bench: Workbench, nominal: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment]) -> Told:
    """A law that was found at a joint, fitted on with what the others do beside it.

    Args:
        bench: training data of all joints, as the model without the law has them.
        nominal: that model.
        law: found beside it, with the parameters of the whole machine.
        held_out: what decides.

    Returns:
        The last turn that left less of both data than the one before; the law as it was found where none did.
    """
    best = Told(law, bench.training, tuple(held_out))
    if not law.of_the_machine:
        return best
    for _ in range(ROUNDS):
        training, kept = beside(bench, nominal, best.law, held_out)
        one = bench_at(bench.with_training(training), nominal, law.joint)
        own = {free.path: best.law.parameters[free.path] for free in one.nominal}
        at_joint = [experiment for experiment in kept if experiment.joint == law.joint]
        begin = (own, best.law.values)
        turn = fitted(one, nominal, best.law.law, at_joint, law.span, begin, one.fine, valleys=True)
        bench.evaluations += one.evaluations
        before = best.law
        if (
            turn.fit.over_noise >= before.fit.over_noise
            or turn.held_out_over_noise >= before.held_out_over_noise
        ):
            break
        whole = {**nominal.values, **turn.parameters}
        best = Told(replace(turn, parameters=whole, rivals=law.rivals), training, kept)
        if turn.fit.over_noise - 1.0 > (1.0 - FALLING) * (before.fit.over_noise - 1.0):
            break
    return best


def beside(
    bench: Workbench, nominal: Hypothesis, law: FoundLaw, held_out: Sequence[Experiment]
) -> tuple[tuple[Experiment, ...], tuple[Experiment, ...]]:
    """Training and held-out data of all joints, with what these do to each other beside a law.

    Args:
        bench: training data.
        nominal: model to which the law is added.
        law: with the parameters of the whole machine.
        held_out: what decides.
    """
    training = _felt(bench, nominal, law, bench.training, ahead=False)
    return training, _felt(bench, nominal, law, held_out, ahead=True)


def _felt(
    bench: Workbench, nominal: Hypothesis, law: FoundLaw, experiments: Sequence[Experiment], *, ahead: bool
) -> tuple[Experiment, ...]:
    """Recordings as the machine with a law has them; each held-out one with the law's own values there."""
    told: list[Experiment] = []
    held = iter(law.ahead)
    for group in recordings_of(experiments):
        at_joint = any(experiment.joint == law.joint for experiment in group)
        values = next(held) if ahead and at_joint else law.values
        rig = enlarged_rig(bench.rig, nominal, replace(law, values=values))
        told += felt_together(rig, group)
    return tuple(told)
