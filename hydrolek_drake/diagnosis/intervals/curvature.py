"""How far fitted parameters are known: from the curvature of the fit, and from how scores vary over blocks."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.splitting import short_blocks
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.parameter_set import ParameterSet

NORMAL = float(norm.ppf(0.5 + 0.5 * EVIDENCE.confidence))
"""Half of such an interval in standard deviations."""


@dataclass(frozen=True)
class Interval:
    """A fitted parameter in SI.

    Attributes:
        value: fitted.
        low: lower end of the 95 % interval.
        high: upper end.
    """

    value: float
    low: float
    high: float


def covariance_of(fit: Fit) -> np.ndarray:
    """Covariance of the places in the unit cube, equation C = s^2 (J' J)^-1 (Seber, Wild 1989). # (n, n).

    s^2 is the mean squared residual where it exceeds 1, so that a model that misses the noise is not trusted.
    """
    jacobian = fit.with_prior
    scale = max(1.0, fit.over_noise) ** 2
    return scale * np.linalg.pinv(jacobian.T @ jacobian)


def beyond_curvature(fit: Fit, experiments: Sequence[Experiment]) -> np.ndarray:
    """How many times further parameters vary than the curvature tells, 1 at least. # (n,).

    Curvature counts every residual as one of its own. Where a model leaves something out they are coloured, and the
    parameters vary by C (sum over blocks of s s' + P' P) C, with s = J_b' r_b the score of a block and P the prior's
    weights (Huber 1967; White, Econometrica 50 (1982) 1; Ljung 1999, section 9.3). On white residuals both are the same
    but for chance, of which there is little with some 18 blocks a recording.

    Args:
        fit: of these experiments, ended.
        experiments: in the order of its residuals.
    """
    scores = []
    begin = 0
    for experiment in experiments:
        block = short_blocks(experiment)
        count, size = len(experiment.channels), experiment.time.size
        rows = slice(begin, begin + count * size)
        begin += count * size
        each = (fit.jacobian[rows] * fit.residuals[rows, None]).reshape(count, size, -1).sum(axis=0)
        scores += [each[block == b].sum(axis=0) for b in np.unique(block)]
    if len(scores) < 2:
        return np.ones(fit.unit.size)
    varied = np.array(scores).T @ np.array(scores) * len(scores) / (len(scores) - 1)
    curved = covariance_of(fit)
    inverse = curved / max(1.0, fit.over_noise) ** 2
    varied = inverse @ (varied + fit.prior_jacobian.T @ fit.prior_jacobian) @ inverse
    with np.errstate(divide="ignore", invalid="ignore"):
        times = np.sqrt(np.diag(varied) / np.diag(curved))
    return np.fmax(times, 1.0)


def intervals_of(parameters: ParameterSet, fit: Fit, times: np.ndarray | None = None) -> dict[str, Interval]:
    """Full path -> fitted value with its 95 % interval, cut at the range of the search.

    Args:
        parameters: the first ones of the fit; those of a law may follow.
        fit: whose unit cube is theirs.
        times: how much wider than by curvature, `beyond_curvature`; None for as that tells. # (n,)
    """
    half = NORMAL * np.sqrt(np.maximum(np.diag(covariance_of(fit)), 0.0))
    found = {}
    for free, u, h in zip(parameters.free, fit.unit, half if times is None else times * half, strict=False):
        low, high = (free.from_unit(float(np.clip(u + sign * h, 0.0, 1.0))) for sign in (-1.0, 1.0))
        found[free.path] = Interval(free.from_unit(float(u)), low, high)
    return found
