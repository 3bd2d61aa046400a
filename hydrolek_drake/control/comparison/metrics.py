"""Measures by which controllers are compared, appendix G."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from hydrolek_drake.control.laws.law import Array

_MM_PER_M = 1e3


@dataclass(frozen=True)
class StepMeasures:
    """How a step was answered.

    Attributes:
        rise_s: time from 10 to 90 % of the step; NaN if 90 % is never reached.
        overshoot_percent: of the step, in its direction.
        error_deg: size of the mean error over the last part; NaN if the joint has not come to rest there.
        ripple_deg: largest less smallest angle over the last part.
    """

    rise_s: float
    overshoot_percent: float
    error_deg: float
    ripple_deg: float


def step_measures(
    time_s: ArrayLike,
    angle_deg: ArrayLike,
    begin_deg: float,
    end_deg: float,
    *,
    last_s: float,
    still_deg: float,
) -> StepMeasures:
    """Measures of one step, the set point going from `begin_deg` to `end_deg` at the first row.

    Crossings are interpolated between rows.

    Args:
        time_s: shape (n,), rising.
        angle_deg: shape (n,).
        begin_deg: angle before the step.
        end_deg: set point.
        last_s: how long the last part is over which the steady state is judged.
        still_deg: a joint whose angle varies by more there has not reached steady state ("na" in Table 6.9).
    """
    time, angle = np.asarray(time_s, dtype=float), np.asarray(angle_deg, dtype=float)
    share = (angle - begin_deg) / (end_deg - begin_deg)
    rise = _crossing(time, share, 0.9) - _crossing(time, share, 0.1)
    last = angle[time >= time[-1] - last_s]
    ripple = float(np.ptp(last))
    error = float(abs(np.mean(last) - end_deg)) if ripple <= still_deg else np.nan
    return StepMeasures(rise, max(0.0, 100.0 * (float(np.max(share)) - 1.0)), error, ripple)


def _crossing(time: Array, share: Array, level: float) -> float:
    above = np.flatnonzero(share >= level)
    if len(above) == 0:
        return np.nan
    k = int(above[0])
    if k == 0:
        return float(time[0])
    part = (level - share[k - 1]) / (share[k] - share[k - 1])
    return float(time[k - 1] + part * (time[k] - time[k - 1]))


def mean_squared_error(set_point_deg: ArrayLike, angle_deg: ArrayLike) -> float:
    """Mean of the squared set-point error [deg^2]."""
    return float(np.mean((np.asarray(set_point_deg) - np.asarray(angle_deg)) ** 2))


def switching(voltage_V: ArrayLike) -> float:
    """Variance of the differenced voltage [V^2], the thesis's measure of the valves' switching (6.3.1)."""
    return float(np.var(np.diff(np.asarray(voltage_V, dtype=float)), ddof=1))


def spread(values: ArrayLike) -> float:
    """Variance, as MATLAB's `var` computes it (n - 1 in the denominator)."""
    return float(np.var(np.asarray(values, dtype=float), ddof=1))


def tool_error(wanted_m: ArrayLike, reached_m: ArrayLike) -> tuple[float, Array]:
    """Mean length of the end effector's error [mm] and the variance of its components [mm^2].

    Args:
        wanted_m: positions, shape (n, 3).
        reached_m: positions, shape (n, 3).
    """
    error = (np.asarray(wanted_m) - np.asarray(reached_m)) * _MM_PER_M
    return float(np.mean(np.linalg.norm(error, axis=1))), np.var(error, axis=0, ddof=1)
