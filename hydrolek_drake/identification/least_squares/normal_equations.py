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
        square, pull = place.slopes.T @ place.slopes, -place.slopes.T @ place.residuals
        self._square, self._pull = square + prior.T @ prior, pull - prior.T @ off
        held = _held(place)
        self._held_square, self._held_pull = square + held * prior.T @ prior, pull - held * prior.T @ off
        self._unit, self._moving = place.unit, place.moving

    def step(self, damping: float) -> np.ndarray:
        """Marquardt's step within the ranges. # (n,)."""
        index = np.flatnonzero(self._moving & (np.diag(self._square) > 0.0))
        square = self._held_square[np.ix_(index, index)]
        damped = square + damping * np.diag(np.diag(square))
        way = np.zeros(self._unit.size)
        way[index] = lowest_in_box(
            damped, self._held_pull[index], -self._unit[index], 1.0 - self._unit[index]
        )
        return way

    def promises(self, way: np.ndarray) -> float:
        """By how much the squares fall on a way, if the slopes hold."""
        return float(2.0 * self._pull @ way - way @ self._square @ way)


def _held(place: Place) -> float:
    """How much more a step by an observer is held to the prior than the squares are: the mean square that is left.

    Far from the noise what is left is an error of the model, alike from sample to sample, which no weak prior holds:
    what the data at hand tell poorly runs to the ends of its ranges, from where no slope leads back once more is seen.
    Steps that are held the less, the less is left (iteratively regularised Gauss-Newton; Bakushinskii, Computational
    Mathematics and Mathematical Physics 32 (1992) 1353), do not lead there; at the noise they are Marquardt's.
    """
    if place.problem.pull_time is None or place.residuals is None:
        return 1.0
    return max(float(place.residuals @ place.residuals) / max(place.problem.counted, 1), 1.0)


def normal_step(place: Place) -> np.ndarray:
    """The way to the lowest place if the slopes hold, within the ranges. # (n,)."""
    return NormalEquations(place).step(1e-6)
