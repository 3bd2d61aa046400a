"""The error of the reference, which all later recordings share, and evidence that it does not bring about.

The reference leaves the machine's own numbers uncertain by H^-1. What is wrong with them is wrong in every later
recording alike: an effect that imitates it shows the same small size again and again, and likelihood ratios that add
up as if recordings were told apart by noise alone would call it a fault. In the linear model an effect's likeliest
strength changes with the prior's mean m by a row g, so that the reference's error makes the strength c z in all
recordings, c^2 = g H^-1 g', with z standard normal.

Given z, the evidence E_n(z) of strengths beside c z is bounded as without (`evidence`), and so is its mean over z,
weighed by how probable each z is if nothing changed: a mixture over the null hypothesis has the mean one under it, and
exceeds 1 / p with the probability p at most (Ville 1939; Wasserman, Ramdas, Balakrishnan, Universal inference,
Proceedings of the National Academy of Sciences 117, 2020, 16880). So what has been there since the first recording
counts only where the reference excludes it, and what begins later is held against the recordings before, too.
"""

from collections.abc import Sequence

import numpy as np
from scipy.stats import chi2

from hydrolek_drake.watching.settings import SHARED_REACH, SHARED_STEP

SHARED = np.arange(-SHARED_REACH, SHARED_REACH + 0.5 * SHARED_STEP, SHARED_STEP)
"""Errors of the reference among which evidence is weighed, in standard deviations of each effect. # (k,)"""

ALONE = np.zeros(1)
"""Where an effect shares nothing with the reference."""


def prior_of_shared(count: int) -> np.ndarray:
    """Logarithms of how probable each of some errors is before any recording, but for a constant. # (count,)."""
    return -0.5 * (SHARED if count > 1 else ALONE) ** 2


def strength_by_reference(
    slopes: np.ndarray, change: np.ndarray, knowledge: np.ndarray, covariance: np.ndarray
) -> float:
    """Standard deviation of an effect's likeliest strength by what the reference leaves uncertain.

    Args:
        slopes: of the residuals with the machine's own numbers. # (values, n)
        change: of the residuals by a unit of strength. # (values,)
        knowledge: information of the prior with which own numbers are fitted to a recording. # (n, n)
        covariance: of the reference's numbers. # (n, n)
    """
    square = slopes.T @ slopes + knowledge
    own = np.linalg.solve(square, slopes.T @ change)  # by how much own numbers make up for it
    power = float(change @ change - (slopes.T @ change) @ own)
    if power <= 1e-12 * float(change @ change):
        return 0.0  # own numbers make all of it: nothing is told of it anyway
    row = knowledge @ own / power
    return float(np.sqrt(max(row @ covariance @ row, 0.0)))


def shares_of_reference(
    slopes: np.ndarray, knowledge: np.ndarray, covariance: np.ndarray
) -> tuple[float, ...]:
    """What of the squares by which own numbers leave their prior is the reference's error, by independent directions.

    Where nothing changed these squares are the sum of chi squared numbers of one degree of freedom; of each of them so
    large a share, from 0 to 1, is the same in all recordings.

    Args:
        slopes: of the residuals with the machine's own numbers. # (values, n)
        knowledge: information of the prior. # (n, n)
        covariance: of the reference's numbers. # (n, n)
    """
    told = slopes.T @ slopes
    # the squares are (u - m)' W (u - m) of the recording's own estimate u, W the inverse of both uncertainties
    inverse = told - told @ np.linalg.solve(told + knowledge, told)
    # not by Cholesky: numbers that the reference tells very differently leave it singular but for rounding
    squares, axes = np.linalg.eigh(covariance)
    root = axes * np.sqrt(np.clip(squares, 0.0, None))
    shares = np.linalg.eigvalsh(root.T @ inverse @ root)
    return tuple(np.clip(shares[::-1], 0.0, 1.0).tolist())


def beyond_shared(gain: float, shares: Sequence[float], granted: float) -> float:
    """The gain of own numbers without what the reference's error brings to it at most.

    The error's squares are distributed nearly as a multiple of chi squared (Satterthwaite, Biometrics Bulletin 2, 1946,
    110), and distances add up at most.

    Args:
        gain: squares.
        shares: see `shares_of_reference`; none for no error.
        granted: probability with which the error may be larger.
    """
    first, second = sum(shares), sum(share**2 for share in shares)
    if second <= 0.0:
        return gain
    most = second / first * float(chi2.isf(granted, first**2 / second))
    return max(float(np.sqrt(max(gain, 0.0)) - np.sqrt(most)), 0.0) ** 2
