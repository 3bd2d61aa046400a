"""Bounded least squares where a Jacobian takes as long as dozens of steps.

Between Jacobians the slopes are corrected so that they agree with how the residuals really changed on all ways that
were tried since (a multisecant Broyden method; Broyden, Mathematics of Computation 19 (1965) 577; Fang and Saad,
Numerical Linear Algebra with Applications 16 (2009) 197); steps are damped as in Marquardt (SIAM J. 11 (1963) 431). A
new Jacobian is asked for where steps no longer bring what they promise, or promise nothing any more.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.problem import Problem

FALLING = 0.1
"""A step has brought what it promised if the squares fall by this share of it at least."""

PATIENCE = 3
"""So many steps since the last Jacobian may bring less before the next one."""

MOST_JACOBIANS = 8

DAMPED, LESS, MORE = 1e-3, 0.2, 8.0
"""Marquardt's damping at first, after a step that helped, and after one that did not (times what it was)."""

ALIKE = 1e-3
"""Ways that are linear combinations of others to this share tell nothing new."""


class SecantDescent:
    """Bounded least squares of one problem."""

    def __init__(
        self,
        problem: Problem,
        *,
        worth: float,
        stop: Callable[[], bool],
        moving: np.ndarray,
        slopes: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray] | None = None,
        least: float = 0.0,
    ) -> None:
        """Prepare.

        Args:
            problem: residuals and Jacobian.
            worth: it ends where a step promises less than so many squares.
            stop: asked before each rollout; True ends the search with `KeyboardInterrupt`.
            moving: which parameters are searched, the others stay where they start. # (n,)
            slopes: Jacobian at a place with these residuals, of the parameters that move; None for the problem's.
            least: a search from a start ends where a Jacobian beyond the first one brought less than so many squares.
        """
        self.problem = problem
        self.moving = moving
        self._worth = worth
        self._stop = stop
        self._slopes = slopes or problem.jacobian
        self._least = least
        self._prior = problem.prior_jacobian()

    def at(self, unit: np.ndarray) -> Fit:
        """A place as one where a search ended. # unit: (n,)."""
        if self._stop():
            raise KeyboardInterrupt
        problem = self.problem
        left, off = problem.residuals(unit), problem.prior_residuals(unit)

        def slopes() -> np.ndarray:
            return self._slopes(unit, left, self.moving)

        return Fit(unit, left, off, slopes, self._prior, problem.counted, 0, problem.unsure, problem.admitted)

    def from_start(self, start: np.ndarray) -> Fit:
        """Where it ends from a place in the unit cube, with new Jacobians as long as they help. # start: (n,)."""
        before = self.problem.evaluations
        best = self.at(np.clip(start, 0.0, 1.0))
        for number in range(MOST_JACOBIANS):
            begun, best = best, self.led_by(best.jacobian, best, self.moving)
            brought = begun.objective - best.objective
            if best is begun or (number and brought < self._least):
                break
        return replace(best, evaluations=self.problem.evaluations - before)

    def led_by(self, jacobian: np.ndarray, best: Fit, moving: np.ndarray) -> Fit:
        """Where steps led by one Jacobian end, corrected by secants; where they begin if nothing is lower.

        Args:
            jacobian: of some place near. # (values, n)
            best: where they begin.
            moving: which parameters are searched here. # (n,)
        """
        places = np.flatnonzero(moving)
        slopes = jacobian[:, places]
        ways: list[np.ndarray] = []
        changes: list[np.ndarray] = []
        damping, failed = DAMPED, 0
        while failed < PATIENCE:
            corrected_slopes = corrected(slopes, ways, changes)
            way = damped_step(best, corrected_slopes, places, damping)
            promised = promised_fall(best, corrected_slopes, places, way)
            if promised < self._worth:
                break
            there = best.unit.copy()
            there[places] = np.clip(there[places] + way, 0.0, 1.0)
            tried = self.at(there)
            ways.append((tried.unit - best.unit)[places])
            changes.append(tried.residuals - best.residuals)
            fall = best.objective - tried.objective
            failed += not fall > FALLING * promised
            if fall > 0.0:
                best = tried
                damping *= LESS
            else:
                damping *= MORE
        return best


def corrected(jacobian: np.ndarray, ways: list[np.ndarray], changes: list[np.ndarray]) -> np.ndarray:
    """The Jacobian nearest to this one that agrees with how the residuals changed on some ways. # (values, n).

    Args:
        jacobian: of the residuals, as far as it is known. # (values, n)
        ways: from one place to another one. # each (n,)
        changes: of the residuals on these ways. # each (values,)
    """
    if not ways:
        return jacobian
    along, change = np.stack(ways, axis=1), np.stack(changes, axis=1)
    return jacobian + (change - jacobian @ along) @ np.linalg.pinv(along, rcond=ALIKE)


def damped_step(best: Fit, jacobian: np.ndarray, places: np.ndarray, damping: float) -> np.ndarray:
    """Marquardt's step within the ranges, with the prior of the parameters. # (searched,).

    Args:
        best: where it begins.
        jacobian: of the residuals with the searched parameters. # (values, searched)
        places: of the searched parameters among all. # (searched,)
        damping: share of the squared columns that is added to the normal equations' diagonal.
    """
    scale = np.linalg.norm(jacobian, axis=0)
    rows = np.vstack([jacobian, best.prior_jacobian[:, places], np.sqrt(damping) * np.diag(scale)])
    wanted = -np.concatenate([best.residuals, best.off_prior, np.zeros(places.size)])
    room = np.finfo(float).eps  # a parameter at an end of its range would leave no room between the bounds
    low, high = -best.unit[places] - room, 1.0 - best.unit[places] + room
    return np.asarray(lsq_linear(rows, wanted, bounds=(low, high)).x)


def promised_fall(best: Fit, jacobian: np.ndarray, places: np.ndarray, way: np.ndarray) -> float:
    """By how much a step lets the squares fall, those of the prior among them, if the slopes hold.

    Args:
        best: where it begins.
        jacobian: of the residuals with the searched parameters. # (values, searched)
        places: of the searched parameters among all. # (searched,)
        way: the step. # (searched,)
    """
    residuals = best.residuals + jacobian @ way
    off_prior = best.off_prior + best.prior_jacobian[:, places] @ way
    return best.objective - float(residuals @ residuals + off_prior @ off_prior)
