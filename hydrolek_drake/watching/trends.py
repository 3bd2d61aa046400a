"""Sizes over time: where their course changes, how fast they grow, and when they reach a limit.

Change points are those between which straight lines leave least, each further one paid for by the squares that chance
would bring (PELT: Killick, Fearnhead, Eckley, Journal of the American Statistical Association 107, 2012, 1590, by
`ruptures`). The last piece is the trend. With its line a + b t and the covariance V of (a, b) it reaches a limit L at
the times t at which (a + b t - L)^2 <= q^2 (V_aa + 2 t V_ab + t^2 V_bb): Fieller's set (Journal of the Royal
Statistical Society B 16, 1954, 175), which has no end where the data do not exclude that it never gets there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from ruptures.base import BaseCost
from ruptures.detection import Pelt
from scipy.optimize import brentq
from scipy.stats import chi2
from scipy.stats import t as student

from hydrolek_drake.diagnosis.intervals.curvature import NORMAL
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.watching.settings import FEWEST, HUBER, NEAR, NORMAL_MEDIAN, REWEIGHTED, SETTLED, TOGETHER

PER_PIECE = 3
"""Numbers that a further piece has: where it begins, level and slope."""


@dataclass(frozen=True)
class Line:
    """A straight line through some points, by weighted least squares.

    Attributes:
        origin: time at which the level is told [s].
        level: there.
        slope: change a second.
        covariance: of level and slope. # (2, 2)
        freedom: points, each by its weight, less two; 1 at least.
    """

    origin: float
    level: float
    slope: float
    covariance: np.ndarray
    freedom: float

    @property
    def quantile(self) -> float:
        """Standard deviations that hold 95 % with so few points."""
        return float(student.ppf(0.5 + 0.5 * EVIDENCE.confidence, self.freedom))

    @property
    def slope_interval(self) -> tuple[float, float]:
        """95 % interval of the slope."""
        half = self.quantile * float(np.sqrt(self.covariance[1, 1]))
        return self.slope - half, self.slope + half

    def at(self, times: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values at some times and half the width of their 95 % band. # times: (k,) [s]."""
        since = np.asarray(times) - self.origin
        v = self.covariance
        variance = v[0, 0] + 2.0 * since * v[0, 1] + since**2 * v[1, 1]
        return self.level + self.slope * since, self.quantile * np.sqrt(np.maximum(variance, 0.0))


@dataclass(frozen=True)
class Reached:
    """When a trend reaches a limit [s since 1970]; infinite where it does not.

    Attributes:
        likeliest: where the line meets it; infinite where the line does not go there.
        earliest: the earliest time that 95 % do not exclude.
        latest: the latest.
    """

    likeliest: float
    earliest: float
    latest: float


@dataclass(frozen=True)
class Trend:
    """The course of one size.

    Attributes:
        changes: times from which another line holds [s since 1970].
        last: the line of the last piece; None for too few points.
        begins: where that piece begins [s since 1970].
    """

    changes: tuple[float, ...]
    last: Line | None
    begins: float

    @property
    def moves(self) -> bool:
        """Whether the last piece has a slope that 95 % tell from none."""
        if self.last is None:
            return False
        low, high = self.last.slope_interval
        return low > 0.0 or high < 0.0


class _Lines(BaseCost):
    """What a straight line leaves of a piece, for `ruptures`; columns: time, value, deviation.

    No single point costs more than `TOGETHER` squares, so that one recording alone makes no change point (bounded loss;
    Fearnhead and Rigaill, Journal of the American Statistical Association 114, 2019).
    """

    model = "bounded_line"
    min_size = FEWEST

    def fit(self, signal: np.ndarray) -> "_Lines":
        """Take the series. # (n, 3)."""
        self.signal = signal
        return self

    def error(self, start: int, end: int) -> float:
        """Cost of the piece [start, end)."""
        time, value, deviation = self.signal[start:end].T
        off, *_ = _fitted(time - time[0], value / deviation, deviation, rounds=1)
        if np.any(off**2 > TOGETHER):  # else plain least squares cost least
            off, *_ = _fitted(time - time[0], value / deviation, deviation)
        return float(np.sum(np.minimum(off**2, TOGETHER)))


def trend_of(
    times: Sequence[float],
    sizes: Sequence[float],
    lows: Sequence[float],
    highs: Sequence[float],
    error_rate: float,
) -> Trend:
    """The course of a size.

    Args:
        times: of the recordings, growing [s since 1970]. # (n,)
        sizes: the likeliest ones. # (n,)
        lows: lower ends of their 95 % intervals. # (n,)
        highs: upper ends. # (n,)
        error_rate: probability with which a course without any change point is given one, about.
    """
    time, size = np.asarray(times, dtype=float), np.asarray(sizes, dtype=float)
    half = np.maximum(np.asarray(highs) - size, size - np.asarray(lows)) / NORMAL
    known = np.isfinite(size) & np.isfinite(half) & (half > 0.0)
    time, size, deviation = time[known], size[known], half[known]
    if time.size < FEWEST or np.ptp(time) <= 0.0:
        return Trend((), None, float(time[0]) if time.size else 0.0)
    span = float(np.ptp(time))
    # an interval much narrower than its neighbours' is that of a jump
    deviation = np.maximum(deviation, _usual(deviation))
    series = np.stack([(time - time[0]) / span, size, deviation], axis=1)
    deviation = np.sqrt(deviation**2 + _between(series))
    series[:, 2] = deviation
    penalty = float(chi2.isf(error_rate / time.size, PER_PIECE))
    pieces = [time.size]
    if time.size >= 2 * FEWEST:
        pieces = Pelt(custom_cost=_Lines(), min_size=FEWEST, jump=1).fit(series).predict(pen=penalty)
    first = pieces[-2] if len(pieces) > 1 else 0
    line = _line(time[first:], size[first:], deviation[first:])
    return Trend(tuple(float(time[end]) for end in pieces[:-1]), line, float(time[first]))


def _between(series: np.ndarray) -> np.ndarray:
    """Variances by which sizes differ from recording to recording beyond what each tells of its own. # (n,).

    Of an effect the machine's own numbers take a share in one recording and none in the next, as its load and moves
    have it, and no interval of a single one holds that: a share of the size's square is added to each variance, the
    same share in all, as between studies (random effects; DerSimonian and Laird, Controlled Clinical Trials 7, 1986,
    177), so that no narrow interval holds the trend. It is told by what lies off the line between neighbours, and its
    median passes over change points.
    """
    time, value, deviation = series.T
    if time.size < 2 * FEWEST:
        return np.zeros_like(value)
    usual = _usual(value) ** 2
    share = (time[1:-1] - time[:-2]) / np.maximum(time[2:] - time[:-2], 1e-12)

    def off_line(variance: np.ndarray) -> np.ndarray:
        return np.asarray(variance[1:-1] + (1.0 - share) ** 2 * variance[:-2] + share**2 * variance[2:])

    squares = (value[1:-1] - (1.0 - share) * value[:-2] - share * value[2:]) ** 2
    known, more = off_line(deviation**2), off_line(usual)
    expected = float(chi2.ppf(0.5, 1))

    def excess(part: float) -> float:
        return float(np.median(squares / (known + part * more))) - expected

    if excess(0.0) <= 0.0:
        return np.zeros_like(value)
    return usual * (float(brentq(excess, 0.0, 1.0)) if excess(1.0) < 0.0 else 1.0)


def _usual(values: np.ndarray) -> np.ndarray:
    """Medians over some values next to each other. # (n,)."""
    if values.size < NEAR:
        return np.full_like(values, np.median(values))
    near = np.pad(values, NEAR // 2, mode="reflect")
    return np.asarray(np.median(np.lib.stride_tricks.sliding_window_view(near, NEAR), axis=1))


def _fitted(
    time: np.ndarray, value: np.ndarray, deviation: np.ndarray, rounds: int = REWEIGHTED
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Residuals, level and slope, covariance and weights of a line; values are over their deviations.

    Where there are enough points, those far off count less: a recording whose own numbers took a part of the effect has
    a size with too narrow an interval. Weights min(1, k s/|r|) with the scatter s by the median of |r| (Huber, Robust
    Statistics, 1981, chapter 7), found by repetition; of one round it is plain weighted least squares.
    """
    columns = np.stack([np.ones_like(time), time], axis=1) / deviation[:, None]
    weight = np.ones_like(time)
    for _ in range(rounds if time.size >= 2 * FEWEST else 1):
        normal = columns.T @ (weight[:, None] * columns)
        found = _solved(normal, columns.T @ (weight * value))
        off, used = value - columns @ found, weight
        size = np.abs(off)
        scatter = max(1.0, float(np.median(size)) / NORMAL_MEDIAN)
        weight = 1.0 / np.maximum(1.0, size / (HUBER * scatter))
        if np.abs(weight - used).max() < SETTLED:
            break
    covariance = np.linalg.pinv(normal)
    return off, found, covariance, used


def _solved(normal: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Level and slope of the normal equations; by their pseudo-inverse where all points have one time."""
    (a, b), (_, d) = normal
    determinant = a * d - b * b
    if determinant <= np.finfo(float).eps * a * d:
        return np.asarray(np.linalg.pinv(normal) @ right)
    return np.array([d * right[0] - b * right[1], a * right[1] - b * right[0]]) / determinant


def _line(time: np.ndarray, size: np.ndarray, deviation: np.ndarray) -> Line:
    """A line by `_fitted`; the covariance grows where the points lie farther off than their deviations say."""
    origin = float(time[-1])
    span = max(float(np.ptp(time)), 1e-9)  # so that both columns are of the same order
    off, found, covariance, weight = _fitted((time - origin) / span, size / deviation, deviation)
    freedom = max(float(weight.sum()) - 2.0, 1.0)
    covariance = covariance * max(1.0, float(np.sum(weight * off**2)) / freedom)
    back = np.diag([1.0, 1.0 / span])
    return Line(origin, float(found[0]), float(found[1] / span), back @ covariance @ back, freedom)


def reached(line: Line, limit: float) -> Reached:
    """When a line reaches a limit, after its last point.

    Args:
        line: of the last piece.
        limit: in the size's unit.
    """
    gap = limit - line.level
    if gap == 0.0 or gap * line.slope <= 0.0:
        likeliest = line.origin if gap == 0.0 else np.inf
    else:
        likeliest = line.origin + gap / line.slope
    span = abs(gap / line.slope) if line.slope else 1.0
    ahead = np.concatenate([[0.0], np.geomspace(1e-4, 1e3, 4001) * span])
    values, half = line.at(line.origin + ahead)
    within = np.abs(values - limit) <= half
    if not within.any():
        return Reached(likeliest, likeliest, likeliest)
    inside = np.flatnonzero(within)
    latest = np.inf if within[-1] else line.origin + float(ahead[inside[-1]])
    return Reached(likeliest, line.origin + float(ahead[inside[0]]), latest)
