"""The direction of a fit's steps: Levenberg's and Marquardt's, within the ranges by an active set.

Marquardt, An algorithm for least-squares estimation of nonlinear parameters, SIAM J. 11 (1963) 431.
"""

import numpy as np

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
        """Marquardt's step within the ranges, by an active set. # (n,)."""
        free = self._moving & (np.diag(self._square) > 0.0)
        way = np.zeros(self._unit.size)
        for _ in range(self._unit.size):
            index = np.flatnonzero(free)
            if not index.size:
                break
            square = self._square[np.ix_(index, index)]
            held = ~free
            pull = self._pull[index] - self._square[np.ix_(index, np.flatnonzero(held))] @ way[held]
            damped = square + damping * np.diag(np.diag(square))
            own = np.linalg.lstsq(damped, pull, rcond=None)[0]
            low, high = -self._unit[index], 1.0 - self._unit[index]
            beyond = (own < low) | (own > high)
            way[index] = np.clip(own, low, high)
            if not beyond.any():
                break
            free[index[beyond]] = False
        return way

    def promises(self, way: np.ndarray) -> float:
        """By how much the squares fall on a way, if the slopes hold."""
        return float(2.0 * self._pull @ way - way @ self._square @ way)


def normal_step(place: Place) -> np.ndarray:
    """The way to the lowest place if the slopes hold, within the ranges. # (n,)."""
    return NormalEquations(place).step(1e-6)
