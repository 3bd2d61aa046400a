"""The moment at which something happens, such as a load that is picked up.

Residuals do not tell least squares where such a moment lies: within an integration step they do not change with it at
all, and from one move of the joint to the next they have hollows. So all moments are gone through.
"""

import itertools
from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.effort import LOOK
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.parameter_set import Free

GRID = 120
"""So many moments are tried over the range: four a second of a recording of half a minute, less than a move takes."""

FINER = 12
"""Each following time, so many between the neighbours of the best one."""

ROUNDS = 3
"""At most: what was fitted to a wrong moment is changed along its tangents, which hold the better the nearer it is."""

TIMES_FINER = 3
"""After which neighbours are a thousandth of the first ones' distance apart, milliseconds, as integration steps are."""


def timed(bench: Workbench, hypothesis: Hypothesis, step: float) -> Hypothesis:
    """A hypothesis fitted again from the best moment of what it has happen; itself if that is no better.

    Args:
        bench: data and fits.
        hypothesis: a fitted one.
        step: integration step [s].
    """
    moments = _moments(hypothesis)
    if not moments:
        return hypothesis
    best = hypothesis
    for _ in range(ROUNDS):
        values = best.values
        for free in moments:
            apart = (free.upper - free.lower) / GRID
            tried = np.linspace(free.lower, free.upper, GRID + 1)
            values = {**values, free.path: _best(bench, best, values, free, tried, step)}
            for _ in range(TIMES_FINER):
                near = values[free.path] + apart * np.linspace(-1.0, 1.0, 2 * FINER + 1)
                tried = np.unique(np.clip(near, free.lower, free.upper))
                values = {**values, free.path: _best(bench, best, values, free, tried, step)}
                apart /= FINER
        again = bench.fit(hypothesis.effects, values, step, LOOK, tolerance=1e-4)
        best = min((again, best), key=lambda h: h.fit.objective)
        if best is not again:
            break
    return best


def _moments(hypothesis: Hypothesis) -> list[Free]:
    return [
        free
        for candidate in hypothesis.effects
        for free, search in zip(candidate.free, candidate.effect.search.values(), strict=True)
        if search.moment
    ]


def _best(
    bench: Workbench,
    hypothesis: Hypothesis,
    values: dict[str, float],
    free: Free,
    moments: Sequence[float] | np.ndarray,
    step: float,
) -> float:
    """The moment that leaves least after the best change of all else; of a plateau, its middle."""
    problem, across = bench.problem(hypothesis.effects, step), Across(hypothesis.fit)

    def error(moment: float) -> float:
        bench.alive()
        unit = problem.parameters.unit({**values, free.path: moment})
        left = across(np.concatenate([problem.residuals(unit), hypothesis.fit.off_prior]))
        return float(left @ left)

    errors = bench.side_by_side(error, list(moments))
    finite = np.nan_to_num(np.array(errors), nan=np.inf)
    first = int(np.argmin(finite))
    alike = len(list(itertools.takewhile(lambda e: e == finite[first], finite[first:])))
    return float(moments[first + (alike - 1) // 2])
