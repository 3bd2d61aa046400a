"""The residuals of joints that move together as a function of the searched parameters: all are rolled out at once."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.recorded_together import OneRecording, recordings_of


def problem_of(
    parameters: ParameterSet, experiments: Sequence[Experiment], *given: Any, **named: Any
) -> Problem:
    """The problem of some experiments, with what joints that move together do to each other if any do.

    Args:
        parameters: what is searched.
        experiments: what must be followed.
        given: as of `Problem`.
        named: as of `Problem`.
    """
    kind = ProblemTogether if any(e.others is not None for e in experiments) else Problem
    return kind(parameters, experiments, *given, **named)


class ProblemTogether(Problem):
    """Weighted residuals of joints that move together, of which all are rolled out at once."""

    batch = 1

    def __init__(self, *given: Any, **named: Any) -> None:
        """Prepare; what is given is that of `Problem`."""
        super().__init__(*given, **named)
        rig = self.parameters.rig
        self._recordings = [OneRecording(rig, group) for group in recordings_of(self.experiments)]
        self._all_move = True
        self._at_anchor: list[tuple[bytes, np.ndarray]] = []

    def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        """As of `Problem`.

        Joints that could move and do not at the first place are held from then on. Pulled rollouts hold every joint to
        what was measured, and with them what it does to the others: they are each joint's own.

        Args:
            units: places in the unit cube. # (n,) each
        """
        if self.pull_time is not None:
            return super().residuals_of_all(units)
        self.evaluations += len(units)
        found = []
        for unit in units:
            records = self.parameters.records(unit)
            if self._all_move:
                self._recordings = [recording.without_still(records) for recording in self._recordings]
                self._all_move = False
            parts = [self._of_recording(i, records) for i in range(len(self._recordings))]
            found.append(self.bounded(parts))
        return found

    def _of_recording(self, i: int, records: np.ndarray) -> np.ndarray:
        """Residuals of one recording; those of the anchor if the records of all joints that could move are the same."""
        recording = self._recordings[i]
        if self._at_anchor and records[recording.places].tobytes() == self._at_anchor[i][0]:
            return self._at_anchor[i][1]
        done = recording.roll_out(records, recording.times, self.longest_step)
        return np.concatenate([e.residuals(recording.signals_of(e, done)) for e in recording.group])

    def _anew(self) -> "ProblemTogether":
        other = super()._anew()
        other._at_anchor = []
        return other

    def _keep(self, unit: np.ndarray, base: np.ndarray) -> None:
        """Keep the residuals at a place: many of a machine's parameters are those of joints that cannot move."""
        super()._keep(unit, base)
        records = self.parameters.records(unit)
        sizes = [sum(len(e.channels) * e.time.size for e in r.group) for r in self._recordings]
        parts = np.split(base, np.cumsum(sizes)[:-1])
        self._at_anchor = [
            (records[r.places].tobytes(), part) for r, part in zip(self._recordings, parts, strict=True)
        ]
