"""Profile likelihood: how badly a model must follow if one parameter is held at another value.

For each value of the parameter all others are fitted anew; where the sum of squared residuals has grown by the
quantile of a chi-squared distribution with one degree of freedom, the confidence interval ends (Raue et al., Structural
and practical identifiability analysis of partially observed dynamical models by exploiting the profile likelihood,
Bioinformatics 25, 2009, equation 8). Unlike the standard error it sees curvature and ends of ranges, and a side on
which it never reaches the threshold is open: the recording does not bound the parameter there.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from hydrolek_drake.identification.least_squares.least_squares import LeastSquares, fit_from

CONFIDENCE = 0.95

FIRST = 0.5
"""First step in standard errors."""

MOST_POINTS = 15
"""On either side."""

WANTED_GROWTH = 0.25
"""Of the threshold from one point to the next; steps are lengthened and shortened towards it."""

SIDES = (-1.0, 1.0)

LONGER, SHORTER = 2.0, 0.5
"""A step changes by no more than these factors."""


@dataclass(frozen=True)
class Profile:
    """The curve of one parameter.

    Attributes:
        index: the parameter's place in the cube's vector.
        places: of the parameter in its range, 0 to 1, rising. # (k,)
        growth: of the squared residuals over the least, over the squared misfit where that exceeds the noise. # (k,)
        threshold: where the interval ends.
        low: end of the interval, 0 to 1; None where the curve stays below the threshold up to the end of the range.
        high: the other end.
        improved: by how much the least on the curve lies below the fit that it began with: above zero, the fit had
            missed the optimum.
        lowest: place of all parameters where the least was. # (n,)
        evaluations: rollouts of all experiments that it took.
        interrupted: whether Ctrl-C ended it early.
    """

    index: int
    places: np.ndarray
    growth: np.ndarray
    threshold: float
    low: float | None
    high: float | None
    improved: float
    lowest: np.ndarray
    evaluations: int
    interrupted: bool = False


def profile(
    problem: LeastSquares,
    unit: np.ndarray,
    index: int,
    deviation: float,
    *,
    confidence: float = CONFIDENCE,
    first: float = FIRST,
    others: Callable[[np.ndarray], tuple[np.ndarray, float]] | None = None,
    progress: Callable[[float, float], None] = lambda place, growth: None,
) -> Profile:
    """Profile of one parameter about a fit.

    Args:
        problem: residuals in units of their noise.
        unit: where the fit ended. # (n,)
        index: which parameter.
        deviation: its standard error there, as a part of its range.
        confidence: of the interval, such as 0.95.
        first: step on either side, in standard errors.
        others: fits all other parameters from a place whose `index` is held: where they end, and what is left
            there; None for a fit to the end.
        progress: told each place and the growth there.
    """
    before = problem.evaluations
    at_fit, off_prior = problem.residuals(unit), problem.prior_residuals(unit)
    begun = Begun.at(unit, at_fit, off_prior, problem.counted)
    others = others or _to_the_end(problem, index)
    sides = [
        walked(begun, index, side, deviation, others, confidence=confidence, first=first, progress=progress)
        for side in SIDES
    ]
    return profile_of(begun, index, sides, confidence, problem.evaluations - before)


@dataclass(frozen=True)
class Begun:
    """The fit about which a profile is told.

    Attributes:
        unit: where it ended. # (n,)
        least: squares there, those of the prior among them.
        scale: squared misfit, where that exceeds the noise.
    """

    unit: np.ndarray
    least: float
    scale: float

    @staticmethod
    def at(unit: np.ndarray, residuals: np.ndarray, off_prior: np.ndarray, counted: int) -> "Begun":
        """A fit by its residuals and its distances from the prior, and how many values count."""
        chi_squared = float(residuals @ residuals)
        return Begun(
            unit, chi_squared + float(off_prior @ off_prior), max(chi_squared / max(counted, 1), 1.0)
        )


@dataclass(frozen=True)
class Side:
    """One side of a profile.

    Attributes:
        places: of all parameters, outwards. # (n,) each
        growth: of the squares over the least of each, over the squared misfit.
        interrupted: whether Ctrl-C ended it early.
    """

    places: tuple[np.ndarray, ...]
    growth: tuple[float, ...]
    interrupted: bool


def walked(
    begun: Begun,
    index: int,
    side: float,
    deviation: float,
    others: Callable[[np.ndarray], tuple[np.ndarray, float]],
    *,
    confidence: float = CONFIDENCE,
    first: float = FIRST,
    progress: Callable[[float, float], None] = lambda place, growth: None,
) -> Side:
    """One side of the profile of one parameter: outwards, until it has passed the threshold or the range's end.

    Args:
        begun: the fit.
        index: which parameter.
        side: -1 towards smaller values, 1 towards larger ones.
        deviation: its standard error, as a part of its range.
        others: fits all other parameters from a place whose `index` is held.
        confidence: of the interval.
        first: step, in standard errors.
        progress: told each place and the growth there.
    """
    step = first * deviation * math.sqrt(begun.scale) if np.isfinite(deviation) else 1.0
    quantile = _allowed(confidence)
    places, growth, interrupted = [], [], False
    try:
        for there, value in _walk(begun.unit, index, side * step, others, begun.scale, begun.least, quantile):
            places.append(there)
            growth.append(value)
            progress(float(there[index]), value)
    except KeyboardInterrupt:
        interrupted = True
    return Side(tuple(places), tuple(growth), interrupted)


def profile_of(
    begun: Begun, index: int, sides: Sequence[Side], confidence: float = CONFIDENCE, evaluations: int = 0
) -> Profile:
    """The profile that sides make up.

    Args:
        begun: the fit.
        index: which parameter.
        sides: of the profile.
        confidence: of the interval.
        evaluations: rollouts that it took.
    """
    quantile = _allowed(confidence)
    told = [
        (begun.unit, 0.0),
        *((u, g) for side in sides for u, g in zip(side.places, side.growth, strict=True)),
    ]
    lowest_place, _ = min(told, key=lambda each: each[1])
    found = {float(u[index]): g for u, g in told}
    places = np.array(sorted(found))
    growth = np.array([found[place] for place in places])
    improved = max(-float(growth.min()), 0.0)
    growth = growth + improved
    lowest = int(np.argmin(growth))
    return Profile(
        index,
        places,
        growth,
        quantile,
        _crossing(places[lowest::-1], growth[lowest::-1], quantile),
        _crossing(places[lowest:], growth[lowest:], quantile),
        improved,
        lowest_place,
        evaluations,
        any(side.interrupted for side in sides),
    )


def _allowed(confidence: float) -> float:
    """By how much the squares grow up to the ends of an interval."""
    return float(chi2.ppf(confidence, 1))


def _to_the_end(problem: LeastSquares, index: int) -> Callable[[np.ndarray], tuple[np.ndarray, float]]:
    """Fits all parameters but one from where they are."""

    def fitted(start: np.ndarray) -> tuple[np.ndarray, float]:
        moving = np.arange(start.size) != index
        if moving.any():
            fit = fit_from(problem, start, moving=moving)
            return fit.unit, fit.objective
        residuals, off = problem.residuals(start), problem.prior_residuals(start)
        return start, float(residuals @ residuals + off @ off)

    return fitted


def _walk(
    unit: np.ndarray,
    index: int,
    step: float,
    others: Callable[[np.ndarray], tuple[np.ndarray, float]],
    scale: float,
    least: float,
    quantile: float,
) -> Iterator[tuple[np.ndarray, float]]:
    """Places and growth outwards by steps that begin with this one, until beyond the threshold or the range's end."""
    end = 0.0 if step < 0.0 else 1.0
    reached = 0.0
    start = unit.copy()
    for _ in range(MOST_POINTS):
        if start[index] == end:
            return
        start[index] = min(max(start[index] + step, 0.0), 1.0)
        there, value = others(start)
        start = there.copy()
        before, reached = reached, (value - least) / scale
        yield there, reached
        if reached > quantile:
            return
        gained = max(reached - before, 0.0)
        step *= min(max(WANTED_GROWTH * quantile / gained if gained > 0.0 else LONGER, SHORTER), LONGER)


def _crossing(places: np.ndarray, growth: np.ndarray, quantile: float) -> float | None:
    """Where a curve that begins at its least first passes the threshold.

    Between two points the root of the growth is taken to be straight: it is, for a linear model.
    """
    above = np.flatnonzero(growth > quantile)
    if not above.size:
        return None
    k = int(above[0])
    inner, outer = np.sqrt(max(growth[k - 1], 0.0)), np.sqrt(growth[k])
    share = (np.sqrt(quantile) - inner) / (outer - inner)
    return float(places[k - 1] + share * (places[k] - places[k - 1]))
