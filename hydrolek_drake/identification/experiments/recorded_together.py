"""A recording of joints that move together, to be rolled out with all of them at once."""

import copy
from collections.abc import Iterable, Sequence

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.physics.probes import SUPPLY
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.driven_by import SUPPLY as SUPPLY_KEY
from hydrolek_drake.rigs.machine.recorded_inputs import Inputs
from hydrolek_drake.rollout.rest import rest_state_at_reading
from hydrolek_drake.rollout.rollout import Signals
from hydrolek_drake.rollout.together.arms import moving_with
from hydrolek_drake.rollout.together.together import JointsTogether, RunTogether, Together

STILL = 1e-6
"""A joint that was not recorded, draws nothing and moves by less [rad] while the others do may be held: rolling it out
takes time and changes nothing."""


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


def recorded_of(rig: Rig, group: Sequence[Experiment]) -> dict[str, Inputs]:
    """What was recorded in place of a part of each joint of a rig, by the experiments of one recording.

    Joints without an experiment feel a recorded supply pressure too.
    """
    found = {e.joint: e.recorded for e in group if e.recorded is not None}
    if SUPPLY_KEY in rig.driven_by and found:
        spacing, rows = next(iter(found.values()))
        shared = np.zeros_like(rows)
        shared[:, SUPPLY] = rows[:, SUPPLY]
        return {joint: (spacing, shared) for joint in rig.joints} | found
    return found


class OneRecording:
    """A recording of joints that move together, ready to be rolled out with all of them at once.

    Attributes:
        group: its experiments.
        places: of all joints that could move, and which alone matter, among the records.
    """

    def __init__(self, rig: Rig, group: Sequence[Experiment], joints: Sequence[str] | None = None) -> None:
        """Prepare.

        Args:
            rig: the machine.
            group: experiments of one recording.
            joints: that move; None for all that can, see `moving_with`.

        Records may be those of all joints for each of several recordings: this one's are the rig's count of joints
        beginning with the place of its first joint, which its experiments' `index` tells.
        """
        self.group = tuple(group)
        self._rig = rig
        self._first = len(rig.joints) * (group[0].index // len(rig.joints))
        can_move = moving_with(rig, [e.joint for e in group])
        self.places = [self._first + rig.joints.index(joint) for joint in can_move]
        self._moving = JointsTogether(rig, joints or can_move)

    def roll_out(self, records: np.ndarray, times: np.ndarray, longest_step: float | None = None) -> Together:
        """What the joints do; arguments as of `run`."""
        return self.run(records, times, longest_step).outcome()

    def run(self, records: np.ndarray, times: np.ndarray, longest_step: float | None = None) -> RunTogether:
        """All joints under the recorded commands, from where they were measured to rest.

        Args:
            records: of all joints of the rig, for each recording that there are records of. # (joints,)
            times: when signals are wanted [s]. # (k,)
            longest_step: of the integration [s]; None for the rig's own.
        """
        first = self._first
        records = records[first : first + len(self._rig.joints)]
        places = records["load"]["initial_position"].copy()
        volts = np.tile(records["command"]["neutral"], (self.group[0].command_times.size, 1))
        for e in self.group:
            at = e.index - first
            volts[:, at] = e.command
            if e.start is not None:
                places[at] = rest_state_at_reading(records[at : at + 1], e.start)[4]
        moving = [self._rig.joints.index(joint) for joint in self._moving.joints]
        return self._moving.run(
            records,
            self.group[0].command_times,
            volts[:, moving],
            times,
            places[moving],
            longest_step,
            recorded_of(self._rig, self.group) or None,
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

    def of(self, group: Sequence[Experiment]) -> "OneRecording":
        """The same joints, for experiments of the same recording that are weighed otherwise."""
        other = copy.copy(self)
        other.group = tuple(group)
        return other

    def signals_of(self, experiment: Experiment, done: Together) -> Signals:
        """What one of the joints did, at its own samples, which are among the times that were asked for."""
        return done.signals_of(experiment.joint, np.searchsorted(done.time, experiment.time))

    @property
    def times(self) -> np.ndarray:
        """Samples of all joints [s]. # (k,)."""
        return np.unique(np.concatenate([e.time for e in self.group]))
