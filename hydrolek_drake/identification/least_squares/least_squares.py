"""Bounded least squares with a robust loss, from one start or from several."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from hydrolek_drake.identification.least_squares.descent import Descent, Land
from hydrolek_drake.identification.problem import Problem

EDGE = 1e-6
"""Starts are pulled so far inside the cube: the trust-region method walks in the interior."""

ROUGH = 1e-3
"""A fit with this tolerance, or a larger one, only leads to others."""


GOOD_ENOUGH = 1.02
"""Times the noise below which further starts could gain hardly anything."""

PULLS_S = (0.03, 0.1)
"""Time constants of the pulled rollouts of fits that begin far off, one after the other. Within the first hardly
anything piles up: what is left of it is nearly the error of the rates themselves, over which the squared residuals have
few local minima (an equation error; Ljung, System Identification, 1999, chapter 7). The second one is longer than a
valve takes to open and a chamber to fill, and far shorter than a move, over which errors pile up."""

PULLED_STEPS, PULLED_TOLERANCE = 8, ROUGH
"""Trust-region steps of a fit with pulled rollouts and its tolerance: it need only lead near."""


class LeastSquares(Land, Protocol):
    """What a search needs of a problem; see `Problem`."""

    @property
    def evaluations(self) -> int:
        """Rollouts of all experiments so far."""
        ...

    @property
    def counted(self) -> int:
        """How many measured values count."""
        ...

    @property
    def unsure(self) -> float:
        """Squared residuals that what is known but roughly may leave; see `Experiment.unsure`."""
        ...

    @property
    def admitted(self) -> float:
        """Squared residuals that equations leave at best; see `Experiment.admitted`."""
        ...


@dataclass(frozen=True)
class Fit:
    """Where a search ended.

    Attributes:
        unit: place in the unit cube. # (n,)
        residuals: there, in units of the noise. # (values,)
        off_prior: distance of each parameter from the rig's own value, in standard deviations. # (n,)
        slopes: d residuals / d unit there, zero for parameters that were held, or what computes it: most fits only lead
            to others, and nobody asks; see `jacobian`. # (values, n)
        prior_jacobian: d off_prior / d unit. # (n, n)
        counted: values that count; where a sample does not count its residual is zero.
        evaluations: rollouts of all experiments that it took, but for those of a Jacobian at its end.
        unsure: squared residuals that what is known but roughly may leave.
        admitted: those among them that equations leave at best.
    """

    unit: np.ndarray
    residuals: np.ndarray
    off_prior: np.ndarray
    slopes: np.ndarray | Callable[[], np.ndarray]
    prior_jacobian: np.ndarray
    counted: int
    evaluations: int
    unsure: float = 0.0
    admitted: float = 0.0

    @property
    def jacobian(self) -> np.ndarray:
        """Change of the residuals with each parameter's place, zero for those that were held. # (values, n)."""
        known = self.slopes() if callable(self.slopes) else self.slopes
        # without the lock of functools' cached property, which would hold up other threads
        object.__setattr__(self, "slopes", known)
        return known

    @property
    def chi_squared(self) -> float:
        """Sum of the squared residuals in units of the noise."""
        return float(self.residuals @ self.residuals)

    @property
    def objective(self) -> float:
        """What was minimised: squared residuals, and squared distances from the prior."""
        return self.chi_squared + float(self.off_prior @ self.off_prior)

    @property
    def with_prior(self) -> np.ndarray:
        """Jacobian of residuals and distances from the prior. # (values + n, n)."""
        return np.concatenate([self.jacobian, self.prior_jacobian])

    @property
    def over_noise(self) -> float:
        """Root mean square of the residuals over the noise: 1 for a perfect model."""
        return math.sqrt(self.chi_squared / max(self.counted, 1))


def fit_from(
    problem: LeastSquares,
    start: np.ndarray,
    *,
    loss: str = "linear",
    most_steps: int = 50,
    tolerance: float = 1e-6,
    stop: Callable[[], bool] | None = None,
    moving: np.ndarray | None = None,
) -> Fit:
    """Bounded least squares from one start (trust region reflective, scipy).

    It ends after so many rollouts, or once a step takes less of the cost, or is shorter, than the tolerance. The slopes
    that lead it need not be exact (`Land.leading_slopes`); where it would end with them it goes on with the
    Jacobian, unless the tolerance is so large that it only leads to others. The Jacobian where it ends is left to whom
    it may concern (`Fit.jacobian`).

    Args:
        problem: residuals and Jacobian.
        start: place in the unit cube. # (n,)
        loss: one of `LOSSES`; all but linear give large residuals less weight.
        most_steps: of the trust-region method, each with one Jacobian but the last.
        tolerance: relative change of cost and parameters at which it ends.
        stop: asked before each rollout; True ends the search with `KeyboardInterrupt`.
        moving: which parameters are searched, the others stay where they start; None for all. # (n,)
    """
    before = problem.evaluations
    unit = np.array(start, dtype=float)
    searched = np.ones(unit.size, dtype=bool) if moving is None else moving
    unit[searched] = np.clip(unit[searched], EDGE, 1.0 - EDGE)
    way = Descent(problem, unit, loss=loss, tolerance=tolerance, stop=stop, moving=moving)
    tried = way.leg(most_steps, exact=False)
    if tolerance < ROUGH and tried < most_steps and not way.exact:
        way.leg(most_steps - tried, exact=True)
    unit, at = way.unit, way.residuals
    return Fit(
        unit=unit,
        residuals=at,
        off_prior=way.off_prior,
        slopes=lambda: problem.jacobian(unit, at, moving),
        prior_jacobian=problem.prior_jacobian(),
        counted=problem.counted,
        evaluations=problem.evaluations - before,
        unsure=problem.unsure,
        admitted=problem.admitted,
    )


def fit_from_afar(
    problem: Problem,
    start: np.ndarray,
    *,
    loss: str = "linear",
    most_steps: int = 50,
    tolerance: float = 1e-6,
    stop: Callable[[], bool] | None = None,
) -> Fit:
    """Least squares from a start far from the optimum, first with pulled rollouts.

    The residuals of a free rollout pile up what went wrong before, and least squares ends in the next local minimum.
    Pulled rollouts forget, as the prediction errors of an observer do (Ljung, System Identification, 1999, chapter 7),
    first at once and then within `PULLS_S`, and lead near; free ones then see what drifts slowly, too.

    Args:
        problem: residuals and Jacobian.
        start: place in the unit cube. # (n,)
        loss: one of `LOSSES`.
        most_steps: with free rollouts.
        tolerance: of their fit, as of `fit_from`.
        stop: as of `fit_from`.
    """
    evaluations = 0
    for pull_time in PULLS_S:
        pulled = problem.pulled(pull_time)
        near = fit_from(
            pulled, start, loss=loss, most_steps=PULLED_STEPS, tolerance=PULLED_TOLERANCE, stop=stop
        )
        start, evaluations = near.unit, evaluations + near.evaluations
    problem.evaluations += evaluations
    fit = fit_from(problem, start, loss=loss, most_steps=most_steps, tolerance=tolerance, stop=stop)
    return replace(fit, evaluations=fit.evaluations + evaluations)


def multi_start(
    problem: Problem,
    starts: Sequence[np.ndarray],
    *,
    loss: str = "linear",
    most_steps: int = 50,
    good_enough: float = GOOD_ENOUGH,
    progress: Callable[[int, Fit], None] | None = None,
) -> Fit:
    """The best of the fits from several starts; ends early once a fit is at the noise.

    Args:
        problem: residuals and Jacobian.
        starts: places in the unit cube, tried in this order; all but the first count as far off. # (n,) each
        loss: one of `LOSSES`.
        most_steps: for each start.
        good_enough: times the noise at which it ends.
        progress: called with number and result after each start.
    """
    best: Fit | None = None
    for number, start in enumerate(starts):
        approach = fit_from_afar if number else fit_from
        fit = approach(problem, start, loss=loss, most_steps=most_steps)
        if best is None or fit.objective < best.objective:
            best = fit
        if progress is not None:
            progress(number, best)
        if best.over_noise <= good_enough:
            break
    assert best is not None
    return best
