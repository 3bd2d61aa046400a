"""The residuals of joints that move together as a function of the searched parameters: all are rolled out at once."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded_together import OneRecording, recordings_of
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.together.lanes import roll_out_together


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

    def __init__(self, *given: Any, known: dict[Any, OneRecording] | None = None, **named: Any) -> None:
        """Prepare.

        Args:
            given: as of `Problem`.
            known: what problems of the same parameters have found of which joints do not move, and that is found here.
            named: as of `Problem`.
        """
        super().__init__(*given, **named)
        self._known_to_move: dict[Any, OneRecording] = {} if known is None else known
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
        places = [self.parameters.records(unit) for unit in units]
        if self._all_move and places:
            self._recordings = [self._moving(recording, places[0]) for recording in self._recordings]
            self._all_move = False
        parts: list[list[np.ndarray | None]] = [[] for _ in units]
        for i, recording in enumerate(self._recordings):
            known = [self._known_of(i, records) for records in places]
            wanted = [k for k, part in enumerate(known) if part is None]
            for at in range(0, len(wanted), LANES):  # what many joints do all the time takes much room
                chosen = wanted[at : at + LANES]
                runs = [recording.run(places[k], recording.times, self.longest_step) for k in chosen]
                for k, done in zip(chosen, roll_out_together(runs), strict=True):
                    known[k] = np.concatenate(
                        [e.residuals(recording.signals_of(e, done)) for e in recording.group]
                    )
            for found, part in zip(parts, known, strict=True):
                found.append(part)
        return [self.bounded([part for part in found if part is not None]) for found in parts]

    def _moving(self, recording: OneRecording, records: np.ndarray) -> OneRecording:
        """A recording without joints that do not move."""
        times, experiments = recording.times, recording.group
        key = (self.parameters.paths, *((e.name, e.joint) for e in experiments), float(times[-1]), times.size)
        if key not in self._known_to_move:
            self._known_to_move[key] = recording.without_still(records)
        return self._known_to_move[key].of(experiments)

    def _known_of(self, i: int, records: np.ndarray) -> np.ndarray | None:
        """Residuals of a recording at the anchor, if the records of all joints that could move are those of there."""
        wanted = records[self._recordings[i].places].tobytes()
        return self._at_anchor[i][1] if self._at_anchor and wanted == self._at_anchor[i][0] else None

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
