"""Whether a step of a least-squares fit was its last one, before a Jacobian is computed where it led."""

import numpy as np

RIGHT = 0.25
"""A step that takes this share of what the Jacobian promised is long enough to end a fit (scipy's rule)."""


class StepsTaken:
    """The steps of a fit, and whether one was the last: by scipy's own rules, told before its last Jacobian."""

    def __init__(self, most: int, tolerance: float, *, robust: bool) -> None:
        """Count from the start.

        Args:
            most: so many places are tried at most.
            tolerance: of a step's length and of what it takes of the cost.
            robust: whether the cost is not the sum of squares: only the number of places then ends the fit here.
        """
        self.ended = False
        self._left = most
        self._tolerance = 0.0 if robust else tolerance
        self._residuals = np.zeros(0)
        self._from: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None

    def tried(self, residuals: np.ndarray) -> None:
        """A place was tried."""
        self._left -= 1
        self._residuals = residuals

    def last(self, place: np.ndarray) -> bool:
        """The place tried last was accepted: whether the fit ends there."""
        self.ended = self._left <= 0 or (self._from is not None and self._converged(place, *self._from))
        return self.ended

    def goes_on(self, place: np.ndarray, slopes: np.ndarray) -> None:
        """It does not: the next step begins there."""
        self._from = (place.copy(), self._residuals, slopes)

    def _converged(
        self, place: np.ndarray, before: np.ndarray, residuals: np.ndarray, slopes: np.ndarray
    ) -> bool:
        way = place - before
        if np.linalg.norm(way) < self._tolerance * (self._tolerance + np.linalg.norm(before)):
            return True
        cost = float(residuals @ residuals)
        taken = cost - float(self._residuals @ self._residuals)
        ahead = residuals + slopes @ way
        return taken < self._tolerance * cost and taken > RIGHT * (cost - float(ahead @ ahead))
