"""What comes of a step that was tried: whether it is taken, with which slopes a fit goes on, and whether it has ended.

Slopes are corrected so that they agree with how the residuals really changed on the ways that were tried (a multisecant
Broyden method; Fang and Saad, Numerical Linear Algebra with Applications 16 (2009) 197).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.identification.least_squares.place import DAMPED, Place

KEPT = 0.25
"""Slopes that brought this share of the fall that they promised are corrected and used again."""

LEAST_DAMPED, MOST_DAMPED = 1e-8, 1e8
"""Dampings that a fit begins its next step with: below the first the step is Newton's, above the last none."""

DIVERGED = 1e6
"""Residuals over the noise of a rollout that ran away: nothing is learnt of slopes there."""

SHORT = 1e6
"""A place from which no step has helped tries steps so many times as damped, once."""


@dataclass(frozen=True)
class Ending:
    """When a fit ends.

    Attributes:
        worth: where a step promises or takes less than so many squares, ...
        share: ... or less than this share of what is left, ...
        behind: ... or less than this share of how far the place is behind the best of them, or noise, ...
        ahead: ... which leave so many squares.
        best: squares that the best of them leaves: ...
        steps: ... a fit that would not come there with so many steps like the next one ends too.
    """

    worth: float = 1.0
    share: float = 1e-3
    behind: float = 0.0
    ahead: float = 0.0
    best: float = 0.0
    steps: float = math.inf

    def least(self, place: Place) -> float:
        """The fall of the squares below which a step is not worth taking."""
        left = place.objective
        return max(
            self.worth, self.share * left, self.behind * (left - self.ahead), (left - self.best) / self.steps
        )


@dataclass(frozen=True)
class Trial:
    """A step that was tried.

    Attributes:
        way: the step. # (n,)
        damping: that it was made with.
        promised: fall of the squares if the slopes hold.
        residuals: where it leads. # (values,)
    """

    way: np.ndarray
    damping: float
    promised: float
    residuals: np.ndarray


def after(place: Place, trials: Sequence[Trial], ending: Ending) -> Place:
    """A place after steps were tried from it: the best of them, or the same with better slopes or as an end.

    Args:
        place: with residuals and slopes.
        trials: steps; none where none promised enough.
        ending: when a fit ends.
    """
    if not trials:
        # what slopes of another place promise nothing of, new ones may
        return _with_better_slopes(place) or replace(place, ended=True)
    reached = [
        replace(place, unit=np.clip(place.unit + t.way, 0.0, 1.0), residuals=t.residuals, fresh=False)
        for t in trials
    ]
    best = min(range(len(trials)), key=lambda i: reached[i].objective)
    fall = place.objective - reached[best].objective
    if fall <= 0.0:
        return _without_gain(place, max(t.damping for t in trials))
    there = replace(reached[best], damping=float(np.clip(trials[best].damping, LEAST_DAMPED, MOST_DAMPED)))
    if fall < ending.least(place):
        there = _with_better_slopes(replace(there, fresh=place.fresh)) or replace(there, ended=True)
        return replace(there, fresh=False)
    held = fall > KEPT * trials[best].promised
    return replace(there, slopes=_corrected(place, trials) if held else None)


def _with_better_slopes(place: Place) -> Place | None:
    """A place whose slopes are to be computed again, over less, or with the problem's own step; None where they are."""
    if not place.fresh:
        return replace(place, slopes=None)
    if place.scale + 1 < len(place.problem.scales):
        return replace(place, slopes=None, scale=place.scale + 1, damping=DAMPED)
    return None if place.exact else replace(place, slopes=None, exact=True)


def _without_gain(place: Place, damped: float) -> Place:
    """A place from which no step has helped: with better slopes, then with shorter steps, then it is an end."""
    better = _with_better_slopes(place)
    if better is not None:
        return better
    if damped > 1e4 * DAMPED:
        return replace(place, ended=True)
    return replace(place, damping=SHORT * place.damping)


def _corrected(place: Place, trials: Sequence[Trial]) -> np.ndarray:
    """The slopes nearest to those of a place that agree with how the residuals changed on some ways. # (values, n)."""
    assert place.slopes is not None and place.residuals is not None
    usable = [t for t in trials if np.abs(t.residuals).max() < DIVERGED]
    if not usable:
        return place.slopes
    along = np.stack([t.way for t in usable], axis=1)
    change = np.stack([t.residuals - place.residuals for t in usable], axis=1)
    return place.slopes + (change - place.slopes @ along) @ np.linalg.pinv(along, rcond=0.05)
