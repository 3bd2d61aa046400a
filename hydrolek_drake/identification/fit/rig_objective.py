"""The objectives of section 4.3 for a rig's recordings, over the unit cube of its parameters."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.objective.norms import NORMS, mean_norm, segment_edges
from hydrolek_drake.identification.problem import Problem


@dataclass(frozen=True)
class RigObjective:
    """Norm (4.13) of all residuals in units of their noise, or of each segment (4.17), (4.18).

    Attributes:
        problem: residuals of all recordings and signals; a perfect model has p = 2 norm 1.
        p: 1, 2 or infinity.
        segments: None for one number; else equal parts of every recording's time, each with all its signals.
    """

    problem: Problem
    p: float = 2.0
    segments: int | None = None

    def __post_init__(self) -> None:
        if self.p not in NORMS:
            raise InputError(f"objective: p is {self.p:g}; choose 1, 2 or inf")
        shortest = min(len(experiment.time) for experiment in self.problem.experiments)
        if self.segments is not None and not 1 <= self.segments <= shortest:
            raise InputError(f"objective: {self.segments} segments of {shortest} samples; choose fewer")

    @property
    def size(self) -> int:
        """How many numbers an evaluation gives."""
        return 1 if self.segments is None else self.segments

    @property
    def batch(self) -> int:
        """So many places are best asked for at once."""
        return self.problem.batch

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Residuals in units of their noise, 0 where a sample does not count."""
        return self.problem.residuals(unit)

    def score(self, residuals: np.ndarray) -> np.ndarray:
        """Value, or values of the segments, of residuals. # (size,)."""
        counted = self._counted()
        if self.segments is None:
            return np.array([mean_norm(residuals[counted], self.p)])
        part = self._segment_of_each()
        return np.array(
            [
                mean_norm(found, self.p) if (found := residuals[counted & (part == k)]).size else 0.0
                for k in range(self.segments)
            ]
        )

    def __call__(self, unit: np.ndarray) -> np.ndarray:
        """Value, or values of the segments, at a place of the unit cube. # (size,)."""
        return self.score(self.residuals(unit))

    def of_all(self, units: Sequence[np.ndarray]) -> list[np.ndarray]:
        """The same at several places, whose machines are rolled out in lanes. # (size,) each."""
        return [self.score(residuals) for residuals in self.problem.residuals_of_all(units)]

    def _counted(self) -> np.ndarray:
        return np.concatenate(
            [
                experiment.used & np.isfinite(channel.measured)
                for experiment in self.problem.experiments
                for channel in experiment.channels
            ]
        )

    def _segment_of_each(self) -> np.ndarray:
        parts = []
        for experiment in self.problem.experiments:
            edges = segment_edges(len(experiment.time), self.segments or 1)
            own = np.searchsorted(edges, np.arange(len(experiment.time)), side="right") - 1
            parts += [own] * len(experiment.channels)
        return np.concatenate(parts)
