"""The residuals of recordings on the Drake Diagram itself: any search runs against the plant, which takes its time."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded_together import recorded_of, recordings_of
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.driving import Driven


class ProblemOnDiagram(Problem):
    """Weighted residuals of several experiments, each recording a run of the Diagram with all its joints.

    A place of the unit cube becomes a rig, a rig a Diagram; it can be sent to other processes, since it holds none.
    There are no pulled rollouts: an observer's corrections are not wired into the Diagram.
    """

    batch = 1

    def __init__(self, parameters: ParameterSet, experiments: Sequence[Experiment]) -> None:
        """Prepare; arguments as of `Problem`."""
        super().__init__(parameters, experiments)
        self._groups = recordings_of(self.experiments)

    def residuals_of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        """See `Problem.residuals_of_all`."""
        self.evaluations += len(units)
        return [self._residuals(unit) for unit in units]

    def _residuals(self, unit: np.ndarray) -> np.ndarray:
        rig = self.parameters.with_rig_values(unit)
        parts = []
        for group in self._groups:
            driven = [Driven(e.joint, e.command_times, e.command, e.start) for e in group]
            done = moved_by_diagram(rig, driven, group[0].time, {}, recorded_of(rig, group))
            parts += [e.residuals(done[e.joint].signals) for e in group]
        return self.bounded(parts)
