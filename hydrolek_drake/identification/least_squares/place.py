"""Where a fit stands: state in, state out."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.problem import Problem

DAMPED = 1e-2
"""Marquardt's damping at first, as a share of the normal equations' diagonal."""


@dataclass(frozen=True)
class Place:
    """Where one of the fits stands.

    Attributes:
        problem: whose residuals are fitted.
        moving: which parameters are searched. # (n,)
        unit: place in the unit cube. # (n,)
        residuals: there; None where nobody has asked yet. # (values,)
        slopes: d residuals / d unit, of some place near; NaN in columns that nobody has asked for yet, None for none of
            them. # (values, n)
        fresh: whether the slopes are of this place.
        scale: which of the problem's differences tell the slopes.
        exact: whether slopes are to be those with the problem's own step.
        damping: that helped last.
        ended: whether nothing is left to gain that would count.
    """

    problem: Problem
    moving: np.ndarray
    unit: np.ndarray
    residuals: np.ndarray | None = None
    slopes: np.ndarray | None = None
    fresh: bool = False
    scale: int = 0
    exact: bool = False
    damping: float = DAMPED
    ended: bool = False

    @property
    def objective(self) -> float:
        """Squared residuals, and squared distances from the prior."""
        assert self.residuals is not None
        off = self.problem.prior_residuals(self.unit)
        return float(self.residuals @ self.residuals + off @ off)

    def at(self, problem: Problem) -> "Place":
        """The same place of another problem of the same parameters, led by the same slopes if it has as many values.

        A damping belongs to its slopes: that with which one observer's fit ended may be so large that no step of the
        next one promises anything.
        """
        if (
            self.slopes is None
            or _values_of(problem) != len(self.slopes)
            or problem.pull_time != self.problem.pull_time
        ):
            return Place(problem, self.moving, self.unit)
        return Place(problem, self.moving, self.unit, slopes=self.slopes, damping=self.damping)


def fit_of(place: Place) -> Fit:
    """A place as one where a fit ended.

    Args:
        place: with residuals.
    """
    problem, unit, residuals, moving = place.problem, place.unit, place.residuals, place.moving
    assert residuals is not None
    return Fit(
        unit=unit,
        residuals=residuals,
        off_prior=problem.prior_residuals(unit),
        slopes=lambda: problem.jacobian(unit, residuals, moving),
        prior_jacobian=problem.prior_jacobian(),
        counted=problem.counted,
        evaluations=problem.evaluations,
        unsure=problem.unsure,
        admitted=problem.admitted,
    )


def _values_of(problem: Problem) -> int:
    """How many residuals a problem has."""
    return sum(len(e.channels) * e.time.size for e in problem.experiments)
