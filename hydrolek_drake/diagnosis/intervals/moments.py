"""How far the moment is known at which something happens, such as a load that is picked up.

A moment has no slope: within an integration step residuals do not change with it at all, and from one move of the joint
to the next they have local minima. So its interval is that of the likelihood ratio over many moments.
"""

import numpy as np
from scipy.stats import chi2

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench, moments_of
from hydrolek_drake.identification.parameter_set import Free
from hydrolek_drake.identification.rolling import Request, residuals_at


def intervals_of_moments(bench: Workbench, hypothesis: Hypothesis, cores: int) -> dict[str, Interval]:
    """Full path -> moment with its 95 % interval: all moments that the residuals do not tell from the best one.

    A moment has no slope, so its interval is that of the likelihood ratio, all else changed along its tangents (Seber,
    Wild, Nonlinear Regression, 1989, chapter 5).

    Args:
        bench: data and problems.
        hypothesis: a fitted model.
        cores: that roll out at the same time.
    """
    found = {}
    for free in moments_of(hypothesis.effects):
        value, apart = hypothesis.values[free.path], (free.upper - free.lower) / EVIDENCE.moments
        tried = np.linspace(free.lower, free.upper, EVIDENCE.moments + 1)
        near = np.clip(
            value + apart * np.linspace(-2.0, 2.0, 4 * EVIDENCE.closer + 1), free.lower, free.upper
        )
        moments = np.unique([*tried, *near, value])
        errors = _errors(bench, hypothesis, free, moments, cores)
        unlike = chi2.ppf(EVIDENCE.confidence, 1) * max(1.0, hypothesis.fit.over_noise) ** 2
        alike = np.flatnonzero(errors <= errors.min() + unlike)
        low, high = max(alike[0] - 1, 0), min(alike[-1] + 1, len(moments) - 1)
        found[free.path] = Interval(value, min(moments[low], value), max(moments[high], value))
    return found


def _errors(
    bench: Workbench, hypothesis: Hypothesis, free: Free, moments: np.ndarray, cores: int
) -> np.ndarray:
    """Squared residuals that each moment leaves after the best change of all else. # (moments,)."""
    problem = bench.problem(hypothesis.effects, bench.fine)
    across, off = Across(hypothesis.fit), hypothesis.fit.off_prior
    units = [problem.parameters.unit({**hypothesis.values, free.path: moment}) for moment in moments]
    [found] = residuals_at([Request(problem, tuple(units))], bench.pool, cores)
    left = [across(np.concatenate([residuals, off])) for residuals in found]
    return np.nan_to_num(np.array([float(each @ each) for each in left]), nan=np.inf)
