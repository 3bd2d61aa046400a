"""Refined instrumental variable estimates of the first-order model (6.1) (Young 2011, chapters 6 and 7)."""

from dataclasses import dataclass

import numpy as np

ITERATIONS = 10
SETTLED = 1e-10
"""Relative change of the parameters at which the iteration ends."""


@dataclass(frozen=True)
class RivEstimate:
    """Parameters of y_k = -a1 y_(k-1) + b v_(k-tau), equation (6.1).

    Attributes:
        a1: -1 for an integrator.
        b: [deg per sample and V].
        a1_error: standard error; 0 where a1 was given.
        b_error: standard error.
        squared_error: sum of (measured - model output)^2 [deg^2].
    """

    a1: float
    b: float
    a1_error: float
    b_error: float
    squared_error: float


def integrator_estimate(angle: np.ndarray, voltage: np.ndarray, delay: int) -> RivEstimate:
    """Refined instrumental variable estimate of b with a1 = -1.

    The optimal prefilter of a model with white noise on its output is 1/A. With A = 1 - z^-1 known it is a
    sum: the filtered equation is y_k = y_0 + b sum_(j <= k) v_(j - tau), whose regressors hold no noise and are
    their own instruments. So the estimate is the regression of the angle on the summed voltage.

    Args:
        angle: y [deg]. # (n,)
        voltage: v [V], its first value before the start too. # (n,)
        delay: tau in samples.
    """
    summed = np.cumsum(_delayed(voltage, delay))
    centred = summed - summed.mean()
    spread = float(centred @ centred)
    if spread == 0.0:
        rest = angle - angle.mean()
        return RivEstimate(-1.0, 0.0, 0.0, np.inf, float(rest @ rest))
    b = float(centred @ angle) / spread
    rest = angle - angle.mean() - b * centred
    squared = float(rest @ rest)
    variance = squared / max(len(angle) - 2, 1)
    return RivEstimate(-1.0, b, 0.0, float(np.sqrt(variance / spread)), squared)


def first_order_estimate(angle: np.ndarray, voltage: np.ndarray, delay: int) -> RivEstimate:
    """Simplified refined instrumental variable estimate of a1 and b.

    The auxiliary model x = b / (1 + a1 z^-1) v makes the instruments; angle, voltage and x are filtered by
    1 / (1 + a1 z^-1), and the instrumental variable equations are solved again until nothing changes. The
    model's start and a constant offset of the voltage's effect are regressors of their own.

    Args:
        angle: y [deg]. # (n,)
        voltage: v [V]. # (n,)
        delay: tau in samples.
    """
    v = _delayed(voltage, delay)
    start = float(np.median(angle[: max(delay, 3)]))
    y = angle - start
    a1, b = -1.0, integrator_estimate(angle, voltage, delay).b
    for _ in range(ITERATIONS):
        x = _filtered(b * v, a1)
        y_f, v_f, x_f = _filtered(y, a1), _filtered(v, a1), _filtered(x, a1)
        one_f = _filtered(np.ones_like(v), a1)
        regressors = np.column_stack([-y_f[:-1], v_f[1:], one_f[1:]])
        instruments = np.column_stack([-x_f[:-1], v_f[1:], one_f[1:]])
        solution, *_ = np.linalg.lstsq(instruments.T @ regressors, instruments.T @ y_f[1:], rcond=None)
        changed = abs(solution[0] - a1) + abs(solution[1] - b)
        a1, b = float(np.clip(solution[0], -1.0, 1.0)), float(solution[1])
        if changed < SETTLED * (1.0 + abs(b)):
            break
    x = _filtered(b * v + float(solution[2]), a1)
    rest = y - x
    rest -= rest.mean()
    squared = float(rest @ rest)
    information = np.linalg.pinv(instruments.T @ instruments) * squared / max(len(y) - 3, 1)
    errors = np.sqrt(np.diag(information))
    return RivEstimate(a1, b, float(errors[0]), float(errors[1]), squared)


def _delayed(voltage: np.ndarray, delay: int) -> np.ndarray:
    return np.concatenate([np.full(delay, voltage[0]), voltage])[: len(voltage)]


def _filtered(values: np.ndarray, a1: float) -> np.ndarray:
    """1 / (1 + a1 z^-1)."""
    from scipy.signal import lfilter

    return lfilter([1.0], [1.0, a1], values)
