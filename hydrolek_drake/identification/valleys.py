"""Ways out of small hollows: along the directions of which the data say least.

A joint that comes to rest, or does not, by a hair's breadth makes the residuals jump, and least squares stops at such
a jump although the land beyond falls on. Where the data tell a combination of parameters but weakly (the scale of a
spool's stroke, say: current, overlap and full opening together), a fit may so end far from the lowest place, in a
valley that is otherwise smooth. A rollout at some places along the valley's floor tells where it is lower.
"""

from collections.abc import Callable

import numpy as np

from hydrolek_drake.identification.least_squares import Fit, LeastSquares, fit_from

VALLEYS = 2
"""So many directions, those that the data tell least."""

SHORTEST = 0.5
"""Standard deviations: nearer places are as likely as the one where the fit ended."""

HALVINGS = 5
"""The farthest place that the ranges leave is tried, and half as far, and so on."""

GAIN = 1.0
"""By so much the squared residuals must fall: one standard deviation of one parameter."""

ROUNDS = 5
"""So many times at most the fit goes on from a lower place."""

STEPS = 6
"""Trust-region steps of a fit from there."""


def along_valleys(
    problem: LeastSquares,
    fit: Fit,
    tolerance: float,
    stop: Callable[[], bool] | None = None,
    moving: np.ndarray | None = None,
) -> Fit:
    """The fit, gone on with from lower places along the directions that the data tell least, if there are any.

    Args:
        problem: of the fit.
        fit: where least squares ended.
        tolerance: of the fits, as of `least_squares.fit_from`.
        stop: as of `least_squares.fit_from`.
        moving: likewise. # (n,)
    """
    for _ in range(ROUNDS):
        lower = _lower(problem, fit)
        if lower is None or (stop is not None and stop()):
            break
        again = fit_from(problem, lower, most_steps=STEPS, tolerance=tolerance, stop=stop, moving=moving)
        if again.objective > fit.objective - GAIN:
            break
        fit = again
    return fit


def _lower(problem: LeastSquares, fit: Fit) -> np.ndarray | None:
    """The lowest of the places along the valleys; None if none is lower by `GAIN`."""
    least, place = fit.objective - GAIN, None
    for way in ways(fit):
        unit = fit.unit + way
        residuals, off = problem.residuals(unit), problem.prior_residuals(unit)
        objective = float(residuals @ residuals + off @ off)
        if objective < least:
            least, place = objective, unit
    return place


def ways(fit: Fit) -> list[np.ndarray]:
    """Ways to the places that are tried. # each (n,).

    The directions are eigenvectors of what the data and the prior tell; along each, both ways, places lie half as far
    as the one before, from the end of the ranges to half a standard deviation.
    """
    slopes = fit.with_prior
    told = np.linalg.norm(slopes, axis=0) > 0.0  # what was held tells nothing
    values, vectors = np.linalg.eigh(slopes[:, told].T @ slopes[:, told])
    found = []
    for value, vector in zip(values[:VALLEYS], vectors.T[:VALLEYS], strict=True):
        direction = np.zeros(fit.unit.size)
        direction[told] = vector
        deviation = 1.0 / np.sqrt(max(value, np.finfo(float).tiny))
        for sign in (1.0, -1.0):
            farthest = _room(fit.unit, sign * direction)
            lengths = farthest * 0.5 ** np.arange(HALVINGS)
            found += [sign * length * direction for length in lengths if length > SHORTEST * deviation]
    return found


def _room(unit: np.ndarray, direction: np.ndarray) -> float:
    """How far one may go in a direction within the ranges."""
    moving = np.abs(direction) > np.finfo(float).eps
    ends = np.where(direction[moving] > 0.0, 1.0, 0.0)
    return float(np.min((ends - unit[moving]) / direction[moving], initial=np.inf))
