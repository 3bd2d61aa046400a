"""The moment at which something happens, such as a load that is picked up.

Residuals do not tell least squares where such a moment lies: within an integration step they do not change with it at
all, and from one move of the joint to the next they have hollows. So fits leave it where it is (`Workbench.fit`), and
moments are gone through: first far apart with a short fit from each, then near the best one.
"""

import itertools
from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import GLANCE, LOOK
from hydrolek_drake.diagnosis.intervals import CONFIDENCE, Interval
from hydrolek_drake.diagnosis.pulled_fits import fit_pulled
from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.unsticking import begun_anew, different
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench, moments_of
from hydrolek_drake.identification.parameter_set import Free

GRID = 120
"""So many moments are tried over the range: four a second of a recording of half a minute, less than a move takes."""

FINER = 12
"""Each following time, so many between the neighbours of the best one."""

ROUNDS = 3
"""At most: what was fitted to a wrong moment is changed along its tangents, which hold the better the nearer it is."""

TIMES_FINER = 3
"""After which neighbours are a thousandth of the first ones' distance apart, milliseconds, as integration steps are."""


def begun(
    bench: Workbench, effects: Sequence[Candidate], starts: Sequence[dict[str, float]], step: float
) -> dict[str, float]:
    """Full path -> value: the best of short fits from the first start with every start's moment of the last effect.

    The whole recording is fitted, for what begins late shows in no part of it. A nominal model that makes up for a load
    from the beginning on is bent so far that other moments promise more than the right one; pulled rollouts of the
    rig's own numbers forget what was before, and one more fit begins at the moment that explains these best.

    Args:
        bench: data and fits.
        effects: what is added to the nominal model; of the last one no moment is known.
        starts: full path -> where the fits begin, the most promising first.
        step: integration step [s].
    """
    paths = [free.path for free in effects[-1].moments]
    if not paths:
        return starts[0]
    moments = different([{path: start[path] for path in paths} for start in starts])
    fits = [
        bench.fit(effects, {**starts[0], **moment}, step, GLANCE, tolerance=1e-3, alone=True)
        for moment in moments
    ]
    known = {path: value for path, value in starts[0].items() if path not in paths}
    pulled = fit_pulled(bench, effects, begun_anew(bench, effects, known), step, bench.training)
    fits.append(bench.refit(pulled, step, GLANCE, tolerance=1e-3, alone=True))
    return min(fits, key=lambda h: h.fit.objective).values


def timed(bench: Workbench, hypothesis: Hypothesis, step: float) -> Hypothesis:
    """A hypothesis fitted again from the best moment of what it has happen; itself if that is no better.

    Args:
        bench: data and fits.
        hypothesis: a fitted one.
        step: integration step [s].
    """
    moments = moments_of(hypothesis.effects)
    if not moments:
        return hypothesis
    best = hypothesis
    for _ in range(ROUNDS):
        values = best.values
        for free in moments:
            apart = (free.upper - free.lower) / GRID
            tried = np.linspace(free.lower, free.upper, GRID + 1)
            values = {**values, free.path: _best(tried, _errors(bench, best, values, free, tried, step))}
            for _ in range(TIMES_FINER):
                near = values[free.path] + apart * np.linspace(-1.0, 1.0, 2 * FINER + 1)
                tried = np.unique(np.clip(near, free.lower, free.upper))
                values = {**values, free.path: _best(tried, _errors(bench, best, values, free, tried, step))}
                apart /= FINER
        again = bench.fit(hypothesis.effects, values, step, LOOK, tolerance=1e-4)
        best = min((again, best), key=lambda h: h.fit.objective)
        if best is not again:
            break
    return best


def intervals_of_moments(bench: Workbench, hypothesis: Hypothesis) -> dict[str, Interval]:
    """Full path -> moment with its 95 % interval: all moments that the residuals do not tell from the best one.

    A moment has no slope, so its interval is that of the likelihood ratio, all else changed along its tangents (Seber,
    Wild, Nonlinear Regression, 1989, chapter 5).
    """
    found = {}
    for free in moments_of(hypothesis.effects):
        value, apart = hypothesis.values[free.path], (free.upper - free.lower) / GRID
        tried = np.linspace(free.lower, free.upper, GRID + 1)
        near = np.clip(value + apart * np.linspace(-2.0, 2.0, 4 * FINER + 1), free.lower, free.upper)
        moments = np.unique([*tried, *near, value])
        errors = _errors(bench, hypothesis, hypothesis.values, free, moments, bench.fine)
        unlike = chi2.ppf(CONFIDENCE, 1) * max(1.0, hypothesis.fit.over_noise) ** 2
        alike = np.flatnonzero(errors <= errors.min() + unlike)
        low, high = max(alike[0] - 1, 0), min(alike[-1] + 1, len(moments) - 1)
        found[free.path] = Interval(value, min(moments[low], value), max(moments[high], value))
    return found


def _best(moments: np.ndarray, errors: np.ndarray) -> float:
    """The moment that leaves least; of a plateau, its middle."""
    first = int(np.argmin(errors))
    alike = len(list(itertools.takewhile(lambda e: e == errors[first], errors[first:])))
    return float(moments[first + (alike - 1) // 2])


def _errors(
    bench: Workbench,
    hypothesis: Hypothesis,
    values: dict[str, float],
    free: Free,
    moments: np.ndarray,
    step: float,
) -> np.ndarray:
    """Squared residuals that each moment leaves after the best change of all else. # (moments,)."""
    problem, across = bench.problem(hypothesis.effects, step), Across(hypothesis.fit)

    def error(moment: float) -> float:
        bench.alive()
        unit = problem.parameters.unit({**values, free.path: moment})
        left = across(np.concatenate([problem.residuals(unit), hypothesis.fit.off_prior]))
        return float(left @ left)

    return np.nan_to_num(np.array(bench.side_by_side(error, list(moments))), nan=np.inf)
