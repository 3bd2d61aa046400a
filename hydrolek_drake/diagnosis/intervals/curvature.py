"""How far fitted parameters are known: from the curvature of the fit."""

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from hydrolek_drake.diagnosis.settings import EVIDENCE
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


def intervals_of(parameters: ParameterSet, fit: Fit) -> dict[str, Interval]:
    """Full path -> fitted value with its 95 % interval, cut at the range of the search.

    Args:
        parameters: the first ones of the fit; those of a law may follow.
        fit: whose unit cube is theirs.
    """
    half = NORMAL * np.sqrt(np.maximum(np.diag(covariance_of(fit)), 0.0))
    found = {}
    for free, u, h in zip(parameters.free, fit.unit, half, strict=False):
        low, high = (free.from_unit(float(np.clip(u + sign * h, 0.0, 1.0))) for sign in (-1.0, 1.0))
        found[free.path] = Interval(free.from_unit(float(u)), low, high)
    return found
