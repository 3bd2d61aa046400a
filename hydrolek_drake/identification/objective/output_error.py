"""Objectives of a model that maps parameters to an output: what the searches evaluate."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.objective.norms import NORMS, mean_norm, relative_norm, segment_norms


@dataclass(frozen=True)
class OutputError:
    """Norm of measured minus model, one number or one for each segment.

    Can be sent to other processes if `model` can.

    Attributes:
        model: parameters (d,) -> output, NaN where it diverged. # (n, ...)
        measured: NaN where it does not count. # (n, ...)
        p: 1, 2 or infinity.
        relative: (4.14) instead of (4.13).
        segments: None for one number; else (4.17), (4.18).
    """

    model: Callable[[np.ndarray], np.ndarray]
    measured: np.ndarray
    p: float = np.inf
    relative: bool = False
    segments: int | None = None

    def __post_init__(self) -> None:
        if self.p not in NORMS:
            raise InputError(f"objective: p is {self.p:g}; choose 1, 2 or inf")
        if self.segments is not None and not 1 <= self.segments <= len(self.measured):
            raise InputError(
                f"objective: {self.segments} segments of {len(self.measured)} samples; "
                f"choose 1 to {len(self.measured)}"
            )
        if self.relative and self.segments is not None:
            raise InputError("objective: the segment form (4.18) is absolute; choose relative or segments")

    @property
    def size(self) -> int:
        """How many numbers an evaluation gives."""
        return 1 if self.segments is None else self.segments

    def residuals(self, point: np.ndarray) -> np.ndarray:
        """Measured minus model, 0 where nothing was measured, NaN where the model diverged."""
        error = self.measured - self.model(point)
        return np.where(np.isfinite(self.measured), error, 0.0)

    def score(self, error: np.ndarray) -> np.ndarray:
        """Value, or values of the segments, of given residuals in the shape of `measured`, or flat. # (size,)."""
        error = error.reshape(self.measured.shape)
        if self.segments is not None:
            return segment_norms(error, self.segments, self.p)
        if self.relative:
            return np.array([relative_norm(error, np.nan_to_num(self.measured), self.p)])
        return np.array([mean_norm(error, self.p)])

    def __call__(self, point: np.ndarray) -> np.ndarray:
        """Value, or values of the segments; NaN after a divergence. # (size,)."""
        return self.score(self.residuals(point))
