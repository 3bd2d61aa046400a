"""What the fitted machine does while an effect that was found is faded in and out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.laws.law import records_of
from hydrolek_drake.diagnosis.report.panels import law_values, shown_experiments
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.run import Run

SHARES = np.linspace(0.0, 1.0, LANES)
"""Shares of an effect's size that are rolled out, as many as one table of lanes holds; a page draws straight lines
between them."""


@dataclass(frozen=True)
class Fading:
    """Something that was found, and the rollouts in which it is there in part.

    Attributes:
        name: id of the effect, or the stage of the law.
        title: in a few words.
        runs: experiment -> rollouts at `SHARES`.
    """

    name: str
    title: str
    runs: Callable[[Experiment], list[Run]]

    def signals(self, experiment: Experiment) -> list[Signals]:
        """What the machine does under the recorded command, with each of `SHARES`."""
        return [outcome.signals for outcome in roll_out_lanes(self.runs(experiment))]


def fadings(diagnosis: Diagnosis) -> list[Fading]:
    """What can be faded at the joint that is shown: each effect of the best structure, a law beside them, and all.

    All other numbers keep their fitted values. Nothing is faded where commands got lost, which did or did not arrive.

    Args:
        diagnosis: with a bench.
    """
    rig, shown = diagnosis.rig, shown_experiments(diagnosis)[0].joint
    listed = [
        c
        for c in diagnosis.best.hypothesis.listed
        if rig.owner(c.effect, c.joint) == rig.owner(c.effect, shown)
    ]
    law = diagnosis.law if diagnosis.law is not None and diagnosis.law.joint == shown else None
    if diagnosis.law is not None and not diagnosis.law.of_the_machine:
        return []
    told = [Fading(c.id, c.effect.title, _runs(diagnosis, (c,), law=False)) for c in listed]
    if law is not None:
        name = f"unlisted.{law.law.input.stage}"
        told.append(Fading(name, "the law found", _runs(diagnosis, (), law=True)))
    if len(told) > 1:
        told.insert(0, Fading("all", "all that was found", _runs(diagnosis, listed, law=law is not None)))
    return told


def _runs(
    diagnosis: Diagnosis, faded: Sequence[Candidate], *, law: bool
) -> Callable[[Experiment], list[Run]]:
    return lambda experiment: [_run(diagnosis, experiment, faded, share, law=law) for share in SHARES]


def _run(
    diagnosis: Diagnosis, experiment: Experiment, faded: Sequence[Candidate], share: float, *, law: bool
) -> Run:
    assert diagnosis.bench is not None
    found = diagnosis.law
    parameters = diagnosis.bench.parameters(diagnosis.best.hypothesis.effects)
    there = found is not None and found.joint == experiment.joint
    values = found.parameters if found is not None and there else diagnosis.best.hypothesis.values
    records = parameters.records(parameters.unit(values))
    for candidate in faded:
        fade(diagnosis, records, candidate, share)
    if found is None or not there:
        return experiment.run(records, diagnosis.step)
    own = law_values(found, [e for e in diagnosis.held_out if e.joint == found.joint], experiment).copy()
    if law:
        own[: found.law.sizes] *= share
    return experiment.run(records, diagnosis.step, law=records_of(found.law, found.span, own))


def fade(diagnosis: Diagnosis, records: np.ndarray, candidate: Candidate, share: float) -> None:
    """Write an effect at a share of its size into the joints' records.

    Its sizes go to their neutral values, a spring's to infinity; moments, time constants and what only shapes it stay.

    Args:
        diagnosis: the outcome.
        records: of all joints, with the effect as it was fitted. # (joints,)
        candidate: the effect and its joint.
        share: 0 for none of it, 1 for all.
    """
    effect, rig = candidate.effect, diagnosis.rig
    for row, joint in enumerate(rig.joints):
        if rig.owner(effect, joint) != rig.owner(effect, candidate.joint):
            continue
        own = records[row]["effects"][effect.key]
        for parameter in effect.parameters:
            size = parameter.name == effect.size
            if effect.weakens:
                if size:
                    own[parameter.name] = own[parameter.name] / share if share > 0.0 else effect.neutral_size
            elif size or (parameter.neutral == 0.0 and parameter.unit != "s"):
                neutral = parameter.neutral or 0.0
                own[parameter.name] = neutral + share * (own[parameter.name] - neutral)
