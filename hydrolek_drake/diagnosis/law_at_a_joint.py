"""A law where several joints were driven: at the joint that is followed worst, with what the others do as known inputs.

Physics in no list is looked for at one joint. The rest of the machine is held where the nominal model was fitted, so
that the joint is one that was driven alone, but for what the others draw from the pump and how they shake it
(`identification.neighbours`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.balance import squares_of
from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.unlisted import find_law
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment


def followed_worst(
    residuals: np.ndarray, held_out: Sequence[Experiment], scales: Mapping[str, Scales]
) -> str | None:
    """The joint of which a model leaves most, for each value that counts; None if there is no room for a law at any.

    Args:
        residuals: that the model leaves, in units of the noise. # (values,)
        held_out: data that nothing was fitted to.
        scales: natural scales of the joints at which there may be a law.
    """
    over = {}
    for joint in scales:
        squares, counted = left_at(joint, residuals, held_out)
        over[joint] = squares / max(counted, 1)
    return max(over, key=lambda joint: over[joint]) if over else None


def left_at(joint: str, residuals: np.ndarray, experiments: Sequence[Experiment]) -> tuple[float, int]:
    """Squared residuals of a joint's own signals, and how many values count there.

    Args:
        joint: its name.
        residuals: of all experiments, in units of the noise. # (values,)
        experiments: in their order.
    """
    place, squares, counted = 0, 0.0, 0
    for experiment in experiments:
        size = len(experiment.channels) * experiment.time.size
        if experiment.joint == joint:
            own = squares_of(residuals[place : place + size], [experiment])
            squares, counted = squares + sum(own.values()), counted + experiment.counted
        place += size
    return squares, counted


@dataclass(frozen=True)
class OneJoint:
    """One of several joints, with the rest of the machine held.

    Attributes:
        joint: its name.
        bench: its data and parameters.
        nominal: the model without effects, fitted to them.
        held_out: its held-out data.
        scales: its natural scales.
        values: full path -> value of all parameters where all joints were fitted.
    """

    joint: str
    bench: Workbench
    nominal: Hypothesis
    held_out: tuple[Experiment, ...]
    scales: Scales
    values: dict[str, float]

    def whole(self, law: FoundLaw) -> FoundLaw:
        """A law that was found at the joint, with the parameters of the whole machine."""
        return replace(law, parameters={**self.values, **law.parameters})


def one_joint(
    bench: Workbench, nominal: Hypothesis, held_out: Sequence[Experiment], joint: str, scales: Scales
) -> OneJoint:
    """A joint by itself.

    Args:
        bench: data of all joints.
        nominal: the model without effects, fitted to them.
        held_out: what decides.
        joint: its name.
        scales: its natural scales.
    """
    one = bench_at(bench, nominal, joint)
    own = {free.path: nominal.values[free.path] for free in one.nominal}
    kept = tuple(e for e in held_out if e.joint == joint)
    return OneJoint(joint, one, one.fit((), own, one.fine, LOOK), kept, scales, nominal.values)


def bench_at(bench: Workbench, nominal: Hypothesis, joint: str) -> Workbench:
    """Data and parameters of a joint, with the rest of the machine as a model has it.

    Args:
        bench: data of all joints.
        nominal: the model without effects, fitted to them.
        joint: its name.
    """
    own = [free for free in bench.nominal if free.path.startswith(f"joints.{joint}.")]
    paths = {free.path for free in own}
    rest = {path: value for path, value in nominal.values.items() if path not in paths}
    at_joint = [e for e in bench.training if e.joint == joint]
    one = Workbench(bench.rig.with_values(rest), own, at_joint, bench.pool)
    one.first_s = bench.first_s
    return one


def law_at_a_joint(
    bench: Workbench, nominal: Hypothesis, held_out: Sequence[Experiment], scales: Mapping[str, Scales]
) -> FoundLaw | None:
    """The law at the joint that is followed worst that explains best what the nominal model leaves there, or None.

    Args:
        bench: data of all joints.
        nominal: the model without effects, fitted to them.
        held_out: what decides.
        scales: natural scales of the joints.
    """
    joint = followed_worst(bench.residuals(nominal, held_out, bench.fine), held_out, scales)
    if joint is None:
        return None
    one = one_joint(bench, nominal, held_out, joint, scales[joint])
    counted = sum(e.counted for e in one.held_out)
    residuals = one.bench.residuals(one.nominal, one.held_out, one.bench.fine)
    law = find_law(one.bench, Judged(one.nominal, residuals, counted), one.held_out, one.scales)
    bench.evaluations += one.bench.evaluations
    return None if law is None else one.whole(law)
