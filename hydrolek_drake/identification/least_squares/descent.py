"""A way down the squared residuals, of one leg or of two."""

from collections.abc import Callable
from typing import Protocol

import numpy as np
from scipy.optimize import least_squares

from hydrolek_drake.identification.least_squares.steps_taken import StepsTaken


class Land(Protocol):
    """What is descended; see `Problem`."""

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        """Residuals in units of their noise. # (n,) -> (values,)."""
        ...

    def jacobian(
        self, unit: np.ndarray, at: np.ndarray | None = None, moving: np.ndarray | None = None
    ) -> np.ndarray:
        """Their change with each parameter's place, zero for those that are held. # (values, n)."""
        ...

    def leading_slopes(
        self, unit: np.ndarray, at: np.ndarray, moving: np.ndarray | None = None
    ) -> np.ndarray | None:
        """The same to within what a step of a search needs, for less; None if only the Jacobian does. # (values, n)."""
        ...

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        """Distances from a prior, in standard deviations."""
        ...

    def prior_jacobian(self) -> np.ndarray:
        """Their change with each parameter's place."""
        ...


class Descent:
    """Bounded least squares (trust region reflective, scipy) that can go on from where it ended with other slopes.

    Attributes:
        unit: the lowest place so far. # (n,)
        residuals: there. # (values,)
        off_prior: distances from the prior there. # (n,)
        exact: whether the last slopes were the Jacobian.
    """

    def __init__(
        self,
        land: Land,
        start: np.ndarray,
        *,
        loss: str,
        tolerance: float,
        stop: Callable[[], bool] | None,
        moving: np.ndarray | None,
    ) -> None:
        """Begin.

        Args:
            land: residuals.
            start: place within the unit cube. # (n,)
            loss: of the residuals, as in scipy.
            tolerance: relative change of cost and parameters at which a leg ends.
            stop: asked before each rollout; True ends the descent with `KeyboardInterrupt`.
            moving: which parameters are searched; None for all. # (n,)
        """
        self.unit = start
        self.residuals = np.zeros(0)
        self.off_prior = np.zeros(0)
        self.exact = False
        self._land, self._loss, self._tolerance = land, loss, tolerance
        self._stop, self._moving = stop, moving
        self._searched = np.flatnonzero(np.ones(start.size) if moving is None else moving)
        self._prior_jacobian = land.prior_jacobian()
        self._known: dict[bytes, np.ndarray] = {}

    def leg(self, most_steps: int, *, exact: bool) -> int:
        """Go down, and how many places were tried.

        It ends as scipy's does, without the slopes at its end.

        Args:
            most_steps: so many places at most.
            exact: with the Jacobian; else with what leads for less, where there is such.
        """
        taken = StepsTaken(most_steps, self._tolerance, robust=self._loss != "linear")

        def jacobian(part: np.ndarray) -> np.ndarray:
            unit = self._whole(part)
            value = self._known[unit.tobytes()]
            if taken.last(part):
                return np.zeros((value.size + len(self._prior_jacobian), self._searched.size))
            slopes = None if exact else self._land.leading_slopes(unit, value, self._moving)
            self.exact = slopes is None
            if slopes is None:
                slopes = self._land.jacobian(unit, value, self._moving)
            own = np.concatenate([slopes, self._prior_jacobian])
            taken.goes_on(part, own[:, self._searched])
            return own[:, self._searched]

        def residuals(part: np.ndarray) -> np.ndarray:
            every = self._tried(part)
            taken.tried(every)
            return every

        result = least_squares(
            residuals,
            self.unit[self._searched],
            jac=jacobian,
            bounds=(0.0, 1.0),
            loss=self._loss,
            max_nfev=most_steps,
            xtol=self._tolerance,
            ftol=self._tolerance,
            gtol=1e-12,
        )
        self.unit = self._whole(result.x)
        values = len(result.fun) - len(self._prior_jacobian)
        self.residuals, self.off_prior = result.fun[:values], result.fun[values:]
        self._known = {self.unit.tobytes(): self.residuals}
        return int(result.nfev)

    def _whole(self, part: np.ndarray) -> np.ndarray:
        """The place, with what is not searched. # (n,)."""
        unit = self.unit.copy()
        unit[self._searched] = part
        return unit

    def _tried(self, part: np.ndarray) -> np.ndarray:
        """Residuals and distances from the prior at a place. # (values + n,)."""
        if self._stop is not None and self._stop():
            raise KeyboardInterrupt
        unit = self._whole(part)
        value = self._known.get(unit.tobytes())  # where the last leg ended
        if value is None:
            value = self._land.residuals(unit)
        self._known = {unit.tobytes(): value}
        return np.concatenate([value, self._land.prior_residuals(unit)])
