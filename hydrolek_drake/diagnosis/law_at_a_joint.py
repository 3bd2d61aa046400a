"""A law where several joints were driven: at the joint that is followed worst, with what the others do as known inputs.

Physics in no list is looked for at one joint. The rest of the machine is held where the nominal model was fitted, so
that the joint is one that was driven alone, but for what the others draw from the pump and how they shake it
(`identification.neighbours`).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.balance import squares_of
from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.unlisted import find_law
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.effects.scales import Scales
from hydrolek_drake.identification.experiment import Experiment


def followed_worst(
    nominal: Judged, held_out: Sequence[Experiment], scales: Mapping[str, Scales]
) -> str | None:
    """The joint of which a model leaves most, for each value that counts; None if there is no room for a law at any.

    Args:
        nominal: the model.
        held_out: data that nothing was fitted to.
        scales: natural scales of the joints at which there may be a law.
    """
    over = {}
    for joint in scales:
        squares, counted = left_at(joint, nominal.held_out, held_out)
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


def law_at_a_joint(
    bench: Workbench, nominal: Judged, held_out: Sequence[Experiment], scales: Mapping[str, Scales]
) -> FoundLaw | None:
    """The law at the joint that is followed worst that explains best what the nominal model leaves there, or None.

    Args:
        bench: data of all joints.
        nominal: the model without effects, fitted to them.
        held_out: what decides.
        scales: natural scales of the joints.
    """
    joint = followed_worst(nominal, held_out, scales)
    if joint is None:
        return None
    values = nominal.hypothesis.values
    own = {path: value for path, value in values.items() if path.startswith(f"joints.{joint}.")}
    rest = {path: value for path, value in values.items() if path not in own}
    one = Workbench(
        bench.rig.with_values(rest),
        [free for free in bench.nominal if free.path in own],
        [e for e in bench.training if e.joint == joint],
        bench.pool,
    )
    one.first_s = bench.first_s
    kept = [e for e in held_out if e.joint == joint]
    fitted = one.fit((), own, one.fine, LOOK)
    counted = sum(e.counted for e in kept)
    alone = Judged(fitted, one.residuals(fitted, kept, one.fine), counted)
    law = find_law(one, alone, kept, scales[joint])
    bench.evaluations += one.evaluations
    return None if law is None else replace(law, parameters={**values, **law.parameters})
