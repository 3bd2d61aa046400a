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


@dataclass(frozen=True)
class Profile:
    """The profile likelihood of a size: how far the squares rise where it is held and all other numbers are fitted.

    Between the sizes that were tried the signed root of the rise above the least is straight, as it is throughout where
    the model is linear (Bates, Watts, Nonlinear Regression Analysis, 1988, section 6.1). A rise that a size farther out
    is below is one of a fit that did not get there, and counts no more than that one.

    Attributes:
        sizes: strengths, growing. # (k,)
        rises: squares there less those without the effect, in units of what the reference leaves. # (k,)
    """

    sizes: tuple[float, ...]
    rises: tuple[float, ...]

    @property
    def best(self) -> float:
        """The likeliest size."""
        return self.sizes[int(np.argmin(self.rises))]

    @property
    def least(self) -> float:
        """The rise there."""
        return min(self.rises)

    @property
    def course(self) -> tuple[np.ndarray, np.ndarray]:
        """Sizes between which the root is straight, and the roots, both growing. # (m,), (m,)."""
        sizes, rises = np.array(self.sizes), np.array(self.rises)
        best = int(np.argmin(rises))
        found = np.sqrt(rises - rises[best])
        kept = [best]
        for side in (range(best - 1, -1, -1), range(best + 1, sizes.size)):
            inner: list[int] = []
            for i in side:
                while inner and found[inner[-1]] >= found[i]:
                    inner.pop()
                inner.append(i)
            kept += inner
        index = np.array(sorted(kept))
        return sizes[index], np.sign(index - best) * found[index]

    def roots(self, at: np.ndarray) -> np.ndarray:
        """Standard deviations from the likeliest size, signed; straight on beyond the ends. # (m,)."""
        sizes, roots = self.course
        if sizes.size == 1:
            return np.zeros_like(np.asarray(at, dtype=float))
        first, last = (
            (roots[1] - roots[0]) / (sizes[1] - sizes[0]),
            (roots[-1] - roots[-2]) / (sizes[-1] - sizes[-2]),
        )
        beyond = first * np.minimum(at - sizes[0], 0.0) + last * np.maximum(at - sizes[-1], 0.0)
        return np.asarray(np.interp(at, sizes, roots) + beyond)

    @property
    def deviation(self) -> float:
        """How far from the likeliest size the squares have risen by one, on the nearer side; infinite for unknown."""
        sizes, roots = self.course
        best = int(np.flatnonzero(roots == 0.0)[0])
        beside = [
            abs((sizes[i] - sizes[best]) / roots[i])
            for i in (best - 1, best + 1)
            if 0 <= i < sizes.size and roots[i]
        ]
        return float(min(beside, default=np.inf))

    def told(self, lower: float, upper: float) -> SizeTold:
        """The likeliest size with its interval, of sizes between two ends."""
        ends = []
        for end, sign in ((lower, -1.0), (upper, 1.0)):
            places = self.best + sign * abs(end - self.best) * np.append(np.geomspace(1e-9, 1.0, 361), 1.0)
            far = np.flatnonzero(np.abs(self.roots(places)) >= REACH)
            ends.append(float(places[far[0]]) if far.size else end)
        low, high = max(ends[0], lower), min(ends[1], upper)
        if not low < high:
            return SizeTold(self.best, low, high)
        sizes = np.linspace(low, high, GRID)
        told = told_by(sizes, self.roots(sizes) ** 2)
        return SizeTold(self.best, min(told.low, self.best), max(told.high, self.best))
