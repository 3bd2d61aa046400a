"""Gains of proportional-integral-plus control from a model in non-minimal state-space form."""

from collections.abc import Sequence
from dataclasses import dataclass

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TransferFunction:
    """Discrete model y = B(z^-1) / A(z^-1) u, thesis equations (6.9), (6.10).

    Attributes:
        a: a_1 to a_n of A = 1 + a_1 z^-1 + ... + a_n z^-n.
        b: b_1 to b_m of B = b_1 z^-1 + ... + b_m z^-m; leading zeros are the delay.
    """

    a: tuple[float, ...]
    b: tuple[float, ...]

    def __post_init__(self) -> None:
        """Refuse a model that no input moves."""
        if not self.a or not self.b or not np.all(np.isfinite([*self.a, *self.b])) or not any(self.b):
            raise InputError(
                f"a model for control needs finite a and b, with one b that is not zero; got a={self.a}, b={self.b}"
            )


def integrator(delay_samples: int, gain: float = 1.0) -> TransferFunction:
    """Integrator with delay, a_1 = -1 and b_delay = gain, as every joint is modelled for control (6.1.2).

    Raises:
        InputError: a delay below one sample.
    """
    if delay_samples < 1:
        raise InputError(f"delay of {delay_samples} samples: a sampled model needs at least 1")
    return TransferFunction((-1.0,), (*[0.0] * (delay_samples - 1), gain))


@dataclass(frozen=True)
class PipGains:
    """State feedback of (6.16): u = -f y - g u_past + k_I z.

    Attributes:
        f: gains on y_k, y_(k-1), ..., shape (n,).
        g: gains on u_(k-1), u_(k-2), ..., shape (m - 1,).
        k_i: gain on the integral of error.
    """

    f: tuple[float, ...]
    g: tuple[float, ...]
    k_i: float


def nonminimal_state_space(model: TransferFunction) -> tuple[Array, Array, Array, Array]:
    """State-space matrices F, g, d, h, thesis equations (6.13), (6.14), for any order.

        x_k = F x_(k-1) + g u_(k-1) + d yd_k,  y_k = h x_k
        x_k = [y_k ... y_(k-n+1), u_(k-1) ... u_(k-m+1), z_k],  z_k = z_(k-1) + yd_k - y_k  (6.11), (6.12)

    Returns:
        F (s, s), g (s, 1), d (s, 1), h (1, s), with s = n + m.
    """
    n, m = len(model.a), len(model.b)
    size = n + m
    f, g, d, h = np.zeros((size, size)), np.zeros((size, 1)), np.zeros((size, 1)), np.zeros((1, size))
    f[0, :n] = -np.array(model.a)
    f[0, n : size - 1] = model.b[1:]
    g[0, 0] = model.b[0]
    for i in range(1, n):
        f[i, i - 1] = 1.0
    if m > 1:
        g[n, 0] = 1.0
        for i in range(n + 1, size - 1):
            f[i, i - 1] = 1.0
    f[-1] = -f[0]
    f[-1, -1] = 1.0
    g[-1, 0] = -g[0, 0]
    d[-1, 0] = 1.0
    h[0, 0] = 1.0
    return f, g, d, h


def lq_gains(model: TransferFunction, error: float, inputs: float, output: float) -> PipGains:
    """Gains that minimise a quadratic cost, as PIPOPT of the CAPTAIN toolbox does (section 6.2.2).

    The cost weighs the integral of error with q_e = `error`, each of the m input terms (the m - 1 past
    inputs of the state and the input itself) with q_u = `inputs` / m, each of the n outputs with
    q_y = `output` / n. The weights stand in this order in the thesis's "PIPOPT weighting [a, b, ...]".

    Raises:
        InputError: weights that are not positive, or for which no stabilising gains exist.
    """
    if not (error > 0.0 and inputs > 0.0 and output >= 0.0):
        raise InputError(
            f"LQ weights: error {error:g} and inputs {inputs:g} must be above 0, output {output:g} not below"
        )
    n, m = len(model.a), len(model.b)
    f, g, _, _ = nonminimal_state_space(model)
    q = np.diag([*[output / n] * n, *[inputs / m] * (m - 1), error])
    try:
        gain, _, _ = control.dlqr(f, g, q, [[inputs / m]])
    except (np.linalg.LinAlgError, ValueError, control.ControlArgument) as reason:
        raise InputError(f"no stabilising gains for a={model.a}, b={model.b}: {reason}") from None
    return _split(np.asarray(gain)[0], n)


def pole_gains(model: TransferFunction, poles: ArrayLike) -> PipGains:
    """Gains that put the closed loop's poles at given places (section 6.2.2; Ackermann's formula).

    Args:
        model: of order n, m.
        poles: n + m places inside the unit circle; complex ones in pairs. Fewer are filled with zeros.

    Raises:
        InputError: too many, unstable or unpaired poles, or a model that cannot be controlled.
    """
    n, m = len(model.a), len(model.b)
    wanted = np.atleast_1d(np.asarray(poles, dtype=complex))
    if len(wanted) > n + m:
        raise InputError(f"{len(wanted)} poles for a loop of order {n + m}; give at most {n + m}")
    if np.any(np.abs(wanted) >= 1.0):
        raise InputError(f"poles {wanted} must lie inside the unit circle")
    wanted = np.concatenate([wanted, np.zeros(n + m - len(wanted))])
    polynomial = np.poly(wanted)
    if np.max(np.abs(np.imag(polynomial))) > np.sqrt(np.finfo(float).eps):
        raise InputError(f"complex poles must come in conjugate pairs; got {wanted}")
    f, g, _, _ = nonminimal_state_space(model)
    columns = [g]
    for _ in range(n + m - 1):
        columns.append(f @ columns[-1])
    reach = np.hstack(columns)
    if np.linalg.matrix_rank(reach) < n + m:
        raise InputError(f"the model a={model.a}, b={model.b} cannot be controlled: a pole cancels a zero")
    last = np.linalg.solve(reach.T, np.eye(n + m)[-1])
    matrix = np.zeros_like(f)
    for coefficient in np.real(polynomial):
        matrix = matrix @ f + coefficient * np.eye(n + m)
    return _split(last @ matrix, n)


def _split(gain: Array, n: int) -> PipGains:
    return PipGains(tuple(map(float, gain[:n])), tuple(map(float, gain[n:-1])), -float(gain[-1]))


def closed_loop_poles(model: TransferFunction, gains: PipGains) -> Array:
    """Poles of set point to angle with u = -K x, thesis equations (6.15), (6.16), (6.18)."""
    f, g, _, _ = nonminimal_state_space(model)
    gain = np.array([[*gains.f, *gains.g, -gains.k_i]])
    return np.linalg.eigvals(f - g @ gain)


def closed_loop_polynomial(model: TransferFunction, gains: PipGains) -> Array:
    """Denominator Dc of the closed loop in rising powers of z^-1, thesis equation (6.18).

    Dc = (1 - z^-1) (G A + F B) + k_I B, with G = 1 + g_1 z^-1 + ..., F = f_0 + f_1 z^-1 + ...
    """
    a, b = np.array([1.0, *model.a]), np.array([0.0, *model.b])
    inner: Array = np.polynomial.polynomial.polyadd(
        np.polynomial.polynomial.polymul([1.0, *gains.g], a), np.polynomial.polynomial.polymul(gains.f, b)
    )
    return np.polynomial.polynomial.polyadd(
        np.polynomial.polynomial.polymul([1.0, -1.0], inner), gains.k_i * b
    )


def forward_path(gains: PipGains, model: TransferFunction) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Numerator and denominator of the forward-path form, section 6.2.7 and Table 6.8.

        num = k_I A,  den = G A + F B

    where the model B / A stands in the inner loop. The thesis's denominators belong to a model with one
    sample less delay than the gains were designed for: [1, g1 - 1, g2 - g1 + f0, -g2] for a delay of 3.
    The filter acts on the summed error, whose pole at 1 the integrator's A = 1 - z^-1 cancels: the
    forward-path form of an integrating joint has no integral action left (docs/guides/control.md).

    Args:
        gains: of the feedback form.
        model: in the inner loop.
    """
    a = np.array([1.0, *model.a])
    den = np.polynomial.polynomial.polyadd(
        np.polynomial.polynomial.polymul([1.0, *gains.g], a),
        np.polynomial.polynomial.polymul(gains.f, [0.0, *model.b]),
    )
    return tuple(map(float, gains.k_i * a)), _trimmed(den)


def _trimmed(coefficients: Sequence[float] | NDArray[np.floating]) -> tuple[float, ...]:
    values = list(map(float, coefficients))
    while len(values) > 1 and values[-1] == 0.0:
        values.pop()
    return tuple(values)
