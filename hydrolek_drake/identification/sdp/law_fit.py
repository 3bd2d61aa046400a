"""The exponential law (6.3) and the linear law (6.20), fitted to the rates of step tests."""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from hydrolek_drake.errors import InputError

NEARLY = 0.97
"""A rate of more than this part of the largest counts as saturated."""


@dataclass(frozen=True)
class RateData:
    """Rates of the step tests of a joint, in degrees per sample.

    Attributes:
        voltage_V: # (n,)
        rate: # (n,)
        error: standard error, the law's own included. # (n,)
        moving: whether the joint moved. # (n,)
    """

    voltage_V: np.ndarray
    rate: np.ndarray
    error: np.ndarray
    moving: np.ndarray

    def side(self, sign: int) -> "RateData":
        """One direction, mirrored to positive voltages and rates, in rising order."""
        order = np.argsort(sign * self.voltage_V)
        order = order[sign * self.voltage_V[order] > 0.0]
        return RateData(
            sign * self.voltage_V[order], sign * self.rate[order], self.error[order], self.moving[order]
        )


@dataclass(frozen=True)
class LawFit:
    """Parameters of a law and their standard errors."""

    values: tuple[float, ...]
    errors: tuple[float, ...]


def fit_exponential(data: RateData) -> LawFit:
    """alpha1 to alpha6 of (6.3).

    With white noise on the angle, and a voltage that is constant after the step, the sum of squared output
    errors of a test depends on the law through its rate alone: it is the squared distance to the estimated
    rate over its variance, plus a constant. The weighted fit to the rates is thus also the fit to the raw
    data that the thesis makes with `fminsearch` (6.1.3). Where fewer than two steps lie between dead-zone and
    saturation, curve and edge have infinite errors.

    Raises:
        InputError: fewer than three steps moved the joint in one direction.
    """
    values, errors = [], []
    for sign in (-1, 1):
        side = _checked(data.side(sign), sign, 3)
        v, q = side.voltage_V, side.rate
        still = v[~side.moving]
        low = float(still.max()) if still.size else 0.0
        first = float(v[side.moving].min())

        def residuals(x: np.ndarray, side: RateData = side) -> np.ndarray:
            law = -x[0] * np.expm1(-x[1] * np.maximum(side.voltage_V - x[2], 0.0))
            return (law - side.rate) / side.error

        saturation = float(q.max())
        fits = [
            least_squares(
                residuals,
                [saturation, curve / max(first, 1e-3), start],
                bounds=([0.0, 0.0, 0.0], [np.inf, np.inf, np.inf]),
                x_scale=[saturation, 1.0, max(first, 1e-3)],
            )
            for curve in (0.5, 2.0, 8.0)
            for start in (0.5 * (low + first), 0.9 * first)
        ]
        best = min(fits, key=lambda fit: fit.cost)
        covariance = np.linalg.pinv(best.jac.T @ best.jac)
        spread = np.sqrt(np.diag(covariance) * max(2.0 * best.cost / max(len(v) - 3, 1), 1.0))
        if _below_saturation(q) < 2:
            spread[1:] = np.inf
        values += [sign * best.x[0], best.x[1], sign * best.x[2]]
        errors += spread.tolist()
    return LawFit(tuple(map(float, values)), tuple(map(float, errors)))


def fit_linear(data: RateData) -> tuple[LawFit, LawFit]:
    """alpha1 to alpha4 and beta1 to beta6 of (6.20).

    A line and a saturation for the steps that move the joint. The edge of the dead-zone beta2 (beta4) lies
    between the largest step without movement and the smallest with it: its middle is taken, or where the
    line crosses zero if that is further out; half the interval is its error. Where fewer than two steps lie
    between dead-zone and saturation, as may be with the levels of 6.1.1, the line's errors are infinite.

    Raises:
        InputError: fewer than three steps moved the joint in one direction.
    """
    alpha, alpha_errors = [], []
    beta, beta_errors = np.zeros(6), np.zeros(6)
    for sign, rate_at, edge_at, end_at in ((-1, 0, 1, 4), (1, 2, 3, 5)):
        side = _checked(data.side(sign), sign, 3)
        moving = side.moving
        v, q, error = side.voltage_V[moving], side.rate[moving], side.error[moving]

        def residuals(
            x: np.ndarray, v: np.ndarray = v, q: np.ndarray = q, e: np.ndarray = error
        ) -> np.ndarray:
            return (np.minimum(x[0] + x[1] * v, x[2]) - q) / e

        slope = (q[1] - q[0]) / (v[1] - v[0])
        start = [q[0] - slope * v[0], slope, float(q.max())]
        best = least_squares(residuals, start, x_scale=np.maximum(np.abs(start), 1e-3))
        covariance = np.linalg.pinv(best.jac.T @ best.jac)
        spread = np.sqrt(np.diag(covariance) * max(2.0 * best.cost / max(len(v) - 3, 1), 1.0))
        intercept, slope, saturation = best.x
        alpha += [sign * intercept, slope]
        alpha_errors += spread[:2].tolist()
        still = side.voltage_V[~moving]
        largest_still = float(still[still < v[0]].max()) if np.any(still < v[0]) else 0.0
        end = (saturation - intercept) / slope
        by_parameter = np.array([-1.0 / slope, -end / slope, 1.0 / slope])
        if _below_saturation(q) < 2:
            alpha_errors[-2:] = [np.inf, np.inf]
        beta[rate_at], beta_errors[rate_at] = sign * saturation, spread[2]
        edge = min(max(0.5 * (largest_still + v[0]), -intercept / slope), v[0])
        beta[edge_at], beta_errors[edge_at] = sign * edge, 0.5 * (v[0] - largest_still)
        beta[end_at], beta_errors[end_at] = sign * end, np.sqrt(by_parameter @ covariance @ by_parameter)
    return (
        LawFit(tuple(map(float, alpha)), tuple(map(float, alpha_errors))),
        LawFit(tuple(map(float, beta)), tuple(map(float, beta_errors))),
    )


def _below_saturation(rate: np.ndarray) -> int:
    """How many steps move the joint with less than its full rate: only they know the law's curve."""
    return int(np.sum((rate > 0.0) & (rate < NEARLY * rate.max())))


def _checked(side: RateData, sign: int, needed: int) -> RateData:
    count = int(side.moving.sum())
    if count < needed:
        raise InputError(
            f"step tests: only {count} steps move the joint in {'positive' if sign > 0 else 'negative'} "
            f"direction; the laws need {needed}"
        )
    return side
