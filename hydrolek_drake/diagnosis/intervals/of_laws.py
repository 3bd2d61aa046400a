"""How far the numbers of a fitted law are known: from the curvature of the fit."""

import math

import numpy as np

from hydrolek_drake.diagnosis.intervals.curvature import NORMAL, Interval, covariance_of
from hydrolek_drake.diagnosis.laws.law import FoundLaw
from hydrolek_drake.diagnosis.settings import LOCATING


def amplitude_intervals(found: FoundLaw) -> list[Interval]:
    """Sizes of a law's terms with their 95 % intervals, or the amplitude of a periodic one (SI).

    Sine and cosine of a periodic one have the amplitude a = sqrt(s^2 + c^2), whose variance is (s, c) C (s, c)' / a^2
    to first order.

    Args:
        found: a fitted law; of commands that got lost, which are each found by themselves, nothing is told.
    """
    if not found.of_the_machine:
        return []
    law = found.law
    own = covariance_of(found.fit)[-law.size :, -law.size :]
    covariance = (2.0 * law.input.scale) ** 2 * own[: law.sizes, : law.sizes]
    if law.periodic:
        [amplitude] = found.amplitudes
        along = found.values[: law.sizes] / max(amplitude, np.finfo(float).tiny)
        variances = [float(along @ covariance @ along)]
    else:
        variances = np.diag(covariance).tolist()
    return [_interval(size, variance) for size, variance in zip(found.amplitudes, variances, strict=True)]


def frequency_interval(found: FoundLaw) -> Interval:
    """Frequency of a periodic law with its 95 % interval [Hz]."""
    return _interval(float(found.values[2]), float(covariance_of(found.fit)[-1, -1]) / LOCATING.scan_s**2)


def _interval(value: float, variance: float) -> Interval:
    half = NORMAL * math.sqrt(max(variance, 0.0))
    return Interval(value, value - half, value + half)
