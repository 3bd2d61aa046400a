"""The likelihood of an effect's size, and the interval that it gives.

Sizes may be one-sided: a leakage is nothing or more. Where the likeliest size is nothing, or near it, an interval from
the curvature would reach below; and a confidence interval of an estimate that is cut off at zero can be empty (Feldman,
Cousins, Physical Review D 57, 1998, 3873). So the interval is the shortest set that holds 95 % of the posterior of the
size, with every possible size alike before: it holds nothing wherever that is likely, and always has an upper end.
"""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.watching.settings import GRID, REACH


@dataclass(frozen=True)
class Branch:
    """How the squares depend on the size, from scans: changes of the residuals at a few sizes, straight between.

    With residuals r and their changes d_k at the sizes s_k, d(0) = 0, the squares are |r + d(s)|^2, where r and d are
    across what the machine's own numbers can make (`diagnosis.fitting.projection`).

    Attributes:
        sizes: growing from 0, of one sign, 0 included. # (k,)
        gram: d_i . d_j, zero for the first. # (k, k)
        along: d_i . r. # (k,)
    """

    sizes: np.ndarray
    gram: np.ndarray
    along: np.ndarray

    def rises(self, at: np.ndarray) -> np.ndarray:
        """Squares at some sizes less those at none; straight on beyond the largest. # (m,)."""
        last = len(self.sizes) - 2
        i = np.clip(np.searchsorted(self.sizes, at, side="right") - 1, 0, last)
        share = (at - self.sizes[i]) / (self.sizes[i + 1] - self.sizes[i])
        less = 1.0 - share
        squares = less**2 * self.gram[i, i] + share**2 * self.gram[i + 1, i + 1]
        squares = squares + 2.0 * less * share * self.gram[i, i + 1]
        return np.asarray(squares + 2.0 * (less * self.along[i] + share * self.along[i + 1]))

    @property
    def reach(self) -> float:
        """A size by which all that is likely lies below: where the squares have surely risen."""
        places = np.geomspace(1e-4, 1e3, 141) * self.sizes[-1]
        rises = self.rises(places)
        likely = np.flatnonzero(rises <= REACH**2 + min(0.0, float(rises.min())))
        last = int(likely[-1]) if likely.size else 0
        return float(places[min(last + 1, places.size - 1)])


@dataclass(frozen=True)
class SizeTold:
    """A size with its interval.

    Attributes:
        size: the likeliest.
        low: lower end of the 95 % interval; 0 where nothing is within it, for a one-sided size.
        high: upper end.
    """

    size: float
    low: float
    high: float


def told_by(sizes: np.ndarray, rises: np.ndarray, scale: float = 1.0) -> SizeTold:
    """The likeliest size and the shortest set of 95 % of exp(-rise / 2).

    Args:
        sizes: growing and evenly spaced. # (m,)
        rises: squares there, less any constant. # (m,)
        scale: squares that count as one.
    """
    likelihood = np.exp(-0.5 * (rises - rises.min()) / scale)
    order = np.argsort(-likelihood, kind="stable")
    mass = np.cumsum(likelihood[order])
    kept = order[: int(np.searchsorted(mass, EVIDENCE.confidence * mass[-1])) + 1]
    return SizeTold(float(sizes[order[0]]), float(sizes[kept.min()]), float(sizes[kept.max()]))


def of_branches(branches: list[Branch], lower: float, upper: float, scale: float) -> SizeTold:
    """A size from its scans: of every other parameter that was tried the best, and both signs where it has two.

    Args:
        branches: scans; of one sign each.
        lower: least size there can be.
        upper: largest.
        scale: squares that count as one.
    """
    ends = [0.0, 0.0]
    for branch in branches:
        side = int(branch.sizes[-1] > 0.0)
        ends[side] = max(ends[side], _mirrored(branch).reach)
    low, high = max(lower, -ends[0]), min(upper, ends[1])
    sizes = np.linspace(low, high, GRID)
    sizes[np.argmin(np.abs(sizes))] = 0.0  # nothing is a place of its own
    rises = np.full(GRID, np.inf)
    for branch in branches:
        sign = 1.0 if branch.sizes[-1] > 0.0 else -1.0
        own = sign * sizes >= 0.0
        rises[own] = np.minimum(rises[own], _mirrored(branch).rises(sign * sizes[own]))
    return told_by(sizes, rises, scale)


def _mirrored(branch: Branch) -> Branch:
    return Branch(np.abs(branch.sizes), branch.gram, branch.along)


def of_fit(size: float, deviation: float, lower: float, upper: float) -> SizeTold:
    """A fitted size with its standard deviation, cut at what is possible."""
    if not deviation > 0.0 or not np.isfinite(deviation):
        return SizeTold(size, lower, upper)
    low, high = max(lower, size - REACH * deviation), min(upper, size + REACH * deviation)
    if not low < high:
        return SizeTold(size, low, high)
    sizes = np.linspace(low, high, GRID)
    told = told_by(sizes, ((sizes - size) / deviation) ** 2)
    return SizeTold(size, min(told.low, size), max(told.high, size))
