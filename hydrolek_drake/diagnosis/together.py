"""What joints that move together do to each other, by rolling out all of them at once.

Joints of one arm shake each other on their oil, faster than smoothed angles tell. Near the noise that matters: a
healthy machine would look as if something were missing. A rollout of all joints with a fitted model's values tells it.
Its motion and flows then stand as known inputs of each joint's own rollout, which gives the same movement at these
values (`neighbours`), and nearly so at values close by: the fit goes on with them and asks again.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.neighbours import probes_of
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import Signals, rest_state_at_reading
from hydrolek_drake.rollout.together import JointsTogether, Together, moving_with

SPACING_S = 1e-3
"""Of the samples of what the joints do [s]: a tenth of the period of the fastest shaking of an arm."""

STILL = 1e-6
"""A joint that was not recorded, draws nothing and moves by less [rad] while the others do may be held: rolling it out
takes time and changes nothing."""


def felt_together(rig: Rig, experiments: Sequence[Experiment]) -> list[Experiment]:
    """The same experiments, those of joints that move together with what the others do by rolling out all.

    Where that leaves all bounds they stay as they are.

    Args:
        rig: the machine with the values of a fitted model.
        experiments: of one or more recordings.
    """
    felt: list[Experiment] = []
    for group in recordings_of(experiments):
        felt += group if group[0].others is None else _felt(rig, group)
    return felt


def recordings_of(experiments: Iterable[Experiment]) -> list[list[Experiment]]:
    """Experiments by the recording that they are of: those of one recording follow each other."""
    groups: list[list[Experiment]] = []
    for experiment in experiments:
        last = groups[-1] if groups else []
        if last and last[0].name == experiment.name and experiment.joint not in {e.joint for e in last}:
            last.append(experiment)
        else:
            groups.append([experiment])
    return groups


class OneRecording:
    """A recording of joints that move together, ready to be rolled out with all of them at once."""

    def __init__(self, rig: Rig, group: Sequence[Experiment], joints: Sequence[str] | None = None) -> None:
        """Prepare.

        Args:
            rig: the machine.
            group: experiments of one recording.
            joints: that move; None for all that can, see `moving_with`.
        """
        self.group = tuple(group)
        self._rig = rig
        self._moving = JointsTogether(rig, joints or moving_with(rig, [e.joint for e in group]))

    def roll_out(self, records: np.ndarray, times: np.ndarray, longest_step: float | None = None) -> Together:
        """All joints under the recorded commands, from where they were measured to rest.

        Args:
            records: of all joints of the rig. # (joints,)
            times: when signals are wanted [s]. # (k,)
            longest_step: of the integration [s]; None for the rig's own.
        """
        places = records["load"]["initial_position"].copy()
        volts = np.tile(records["command"]["neutral"], (self.group[0].command_times.size, 1))
        for e in self.group:
            volts[:, e.index] = e.command
            if e.start is not None:
                places[e.index] = rest_state_at_reading(records[e.index : e.index + 1], e.start)[4]
        moving = [self._rig.joints.index(joint) for joint in self._moving.joints]
        return self._moving.roll_out(
            records, self.group[0].command_times, volts[:, moving], times, places[moving], longest_step
        )

    def without_still(self, records: np.ndarray) -> "OneRecording":
        """The same with joints held that do not move.

        Args:
            records: of all joints of the rig with which they move or not. # (joints,)
        """
        done = self.roll_out(records, self.times)
        recorded = {e.joint for e in self.group}
        kept = [
            joint
            for i, joint in enumerate(done.joints)
            if joint in recorded
            or not np.ptp(done.signals["position"][:, i]) < STILL
            or np.any(done.signals["drawn"][:, i])
        ]
        return OneRecording(self._rig, self.group, kept)

    def signals_of(self, experiment: Experiment, done: Together) -> Signals:
        """What one of the joints did, at its own samples, which are among the times that were asked for."""
        return done.signals_of(experiment.joint, np.searchsorted(done.time, experiment.time))

    @property
    def times(self) -> np.ndarray:
        """Samples of all joints [s]. # (k,)."""
        return np.unique(np.concatenate([e.time for e in self.group]))


def _felt(rig: Rig, group: Sequence[Experiment]) -> list[Experiment]:
    """The joints of one recording, beside each other."""
    begin, end = min(float(e.time[0]) for e in group), max(float(e.time[-1]) for e in group)
    times = begin + SPACING_S * np.arange(int((end - begin) / SPACING_S + 1e-6) + 2)
    records = rig.records()
    done = OneRecording(rig, group).roll_out(records, times)
    if done.diverged is not None:
        return list(group)
    motions, flows = {}, {}
    for i, joint in enumerate(done.joints):
        position, velocity = done.signals["position"][:, i], done.signals["velocity"][:, i]
        motions[joint] = (position, velocity, np.gradient(velocity, SPACING_S))
        flows[joint] = done.signals["drawn"][:, i]
    firsts = {e.joint: float(e.time[0]) - begin for e in group}
    probes = probes_of(rig, motions, flows, SPACING_S, firsts)
    felt = [replace(e, others=probes[e.joint]) for e in group]
    return [replace(e, others_error=_apart(e, records, done)) for e in felt]


def _apart(experiment: Experiment, records: np.ndarray, done: Together) -> np.ndarray:
    """By how much a joint's own rollout differs from that of all at the same values. # (channels, n)."""
    own = experiment.simulate(records).signals
    column = done.joints.index(experiment.joint)
    models = [channel.model for channel in experiment.channels]
    whole = [np.interp(experiment.time, done.time, done.signals[model][:, column]) for model in models]
    return np.array([getattr(own, model) for model in models]) - np.array(whole)
