"""The direction of a fit's steps: Levenberg's and Marquardt's, within the ranges.

Marquardt, An algorithm for least-squares estimation of nonlinear parameters, SIAM J. 11 (1963) 431.
"""

import numpy as np

from hydrolek_drake.identification.least_squares.box import lowest_in_box
from hydrolek_drake.identification.least_squares.place import Place


class NormalEquations:
    """The direction of a step: the normal equations at a place, damped and within the ranges."""

    def __init__(self, place: Place) -> None:
        """Form them.

        Args:
            place: with residuals and slopes.
        """
        assert place.slopes is not None and place.residuals is not None
        prior = place.problem.prior_jacobian()
        off = place.problem.prior_residuals(place.unit)
        self._square = place.slopes.T @ place.slopes + prior.T @ prior
        self._pull = -(place.slopes.T @ place.residuals + prior.T @ off)
        self._unit, self._moving = place.unit, place.moving

    def step(self, damping: float) -> np.ndarray:
        """Marquardt's step within the ranges. # (n,)."""
        index = np.flatnonzero(self._moving & (np.diag(self._square) > 0.0))
        square = self._square[np.ix_(index, index)]
        damped = square + damping * np.diag(np.diag(square))
        way = np.zeros(self._unit.size)
        way[index] = lowest_in_box(damped, self._pull[index], -self._unit[index], 1.0 - self._unit[index])
        return way

    def promises(self, way: np.ndarray) -> float:
        """By how much the squares fall on a way, if the slopes hold."""
        return float(2.0 * self._pull @ way - way @ self._square @ way)


def normal_step(place: Place) -> np.ndarray:
    """The way to the lowest place if the slopes hold, within the ranges. # (n,)."""
    return NormalEquations(place).step(1e-6)
