"""The state-dependent-parameter model of a joint: static nonlinearity, transport delay, integrator.

Angles are in degrees here, as everywhere below the Drake systems of this folder: gains and published
numbers are per degree.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import package_yaml

Array = NDArray[np.float64]


def exponential_rate(voltage_V: ArrayLike, alpha: Sequence[float] | Array) -> Array:
    """Increment of the angle per sample, the state-dependent nonlinearity q{v} of thesis equation (6.3).

        alpha1 (1 - exp(alpha2 (v - alpha3)))   for v < alpha3
        0                                       for alpha3 <= v <= alpha6
        alpha4 (1 - exp(-alpha5 (v - alpha6)))  for v > alpha6

    The thesis prints (1 - alpha1) exp(...), which is not zero at the edge of the dead-zone and does not
    saturate; this form gives its figures and tables (docs/reference/thesis_errata.md).

    Args:
        voltage_V: any shape.
        alpha: alpha1 to alpha6 of Table 6.1: saturation rate [deg per sample], curve [1/V] and edge of the
            dead-zone [V], in negative, then in positive direction.

    Returns:
        [deg per sample], shape of `voltage_V`.
    """
    v = np.asarray(voltage_V, dtype=float)
    a1, a2, a3, a4, a5, a6 = alpha
    below, above = np.minimum(v - a3, 0.0), np.maximum(v - a6, 0.0)
    return -a1 * np.expm1(a2 * below) - a4 * np.expm1(-a5 * above)


def linear_rate(voltage_V: ArrayLike, alpha: Sequence[float] | Array, beta: Sequence[float] | Array) -> Array:
    """Increment of the angle per sample by straight lines, thesis equation (6.20).

        beta1              for v < beta5
        alpha1 + alpha2 v  for beta5 <= v <= beta2
        0                  for beta2 < v < beta4
        alpha3 + alpha4 v  for beta4 <= v <= beta6
        beta3              for v > beta6

    The thesis prints the bounds of the second case in reverse, and beta1 as the last value
    (docs/reference/thesis_errata.md).

    Args:
        voltage_V: any shape.
        alpha: intercept [deg per sample] and slope [deg per sample and V], negative, then positive direction.
        beta: Table 6.7: saturation rates beta1, beta3 [deg per sample], edges of the dead-zone beta2, beta4
            [V] and voltages of saturation beta5, beta6 [V].

    Returns:
        [deg per sample], shape of `voltage_V`.
    """
    v = np.asarray(voltage_V, dtype=float)
    b1, b2, b3, b4, b5, b6 = beta
    cases = [v < b5, v <= b2, v < b4, v <= b6]
    return np.select(cases, [b1, alpha[0] + alpha[1] * v, 0.0, alpha[2] + alpha[3] * v], b3)


@dataclass(frozen=True)
class SdpModel:
    """State-dependent-parameter model of one joint, thesis equations (6.1), (6.2) and (6.19).

        y_k = y_(k-1) + q{v_(k-tau)}, kept within the joint's range

    Attributes:
        name: of the joint or model.
        alpha: of (6.3), shape (6,), or of (6.20), shape (4,).
        beta: of (6.20), shape (6,); None for the exponential law (6.3).
        sample_s: sampling interval [s].
        delay_samples: tau.
        lower_deg: end of the joint's range.
        upper_deg: the other end.
    """

    name: str
    alpha: tuple[float, ...]
    beta: tuple[float, ...] | None
    sample_s: float
    delay_samples: int
    lower_deg: float
    upper_deg: float

    def increment(self, voltage_V: ArrayLike) -> Array:
        """q{v} [deg per sample]."""
        if self.beta is None:
            return exponential_rate(voltage_V, self.alpha)
        return linear_rate(voltage_V, self.alpha, self.beta)

    def rate(self, voltage_V: ArrayLike) -> Array:
        """Angular velocity q{v} / sample [deg/s], as in figure 6.3."""
        return self.increment(voltage_V) / self.sample_s

    @property
    def dead_zone_V(self) -> tuple[float, float]:
        """Lower and upper edge of the dead-zone."""
        if self.beta is None:
            return self.alpha[2], self.alpha[5]
        return self.beta[1], self.beta[3]

    @property
    def saturation_deg_per_s(self) -> tuple[float, float]:
        """Lowest and highest angular velocity."""
        low, high = (self.alpha[0], self.alpha[3]) if self.beta is None else (self.beta[0], self.beta[2])
        return low / self.sample_s, high / self.sample_s

    def voltage_at(self, rate_deg_per_s: float) -> float:
        """Voltage that gives an angular velocity: the inverse of `rate` outside the dead-zone.

        Raises:
            InputError: the velocity is zero, not below saturation, or less than the step at the edge of the
                dead-zone that the straight lines of (6.20) have.
        """
        low, high = self.saturation_deg_per_s
        if rate_deg_per_s == 0.0 or not low < rate_deg_per_s < high:
            raise InputError(
                f"SDP model {self.name}: no voltage gives {rate_deg_per_s:g} deg/s; "
                f"choose within {low:g} to {high:g} deg/s, not 0"
            )
        q = rate_deg_per_s * self.sample_s
        if self.beta is not None:
            intercept, slope = self.alpha[:2] if q < 0.0 else self.alpha[2:]
            voltage = (q - intercept) / slope
            if self.beta[1] < voltage < self.beta[3]:
                raise InputError(
                    f"SDP model {self.name}: the joint cannot move as slowly as {rate_deg_per_s:g} deg/s"
                )
            return voltage
        a1, a2, a3, a4, a5, a6 = self.alpha
        if q < 0.0:
            return float(a3 + np.log1p(-q / a1) / a2)
        return float(a6 - np.log1p(-q / a4) / a5)

    def step(self, angle_deg: float, delayed_V: float) -> float:
        """One sample of (6.2): y_k from y_(k-1) and v_(k-tau)."""
        moved = angle_deg + float(self.increment(delayed_V))
        return min(max(moved, self.lower_deg), self.upper_deg)

    def simulate(self, voltage_V: ArrayLike, initial_deg: float, before_V: float = 0.0) -> Array:
        """Open-loop response.

        Args:
            voltage_V: v_0, v_1, ..., shape (n,).
            initial_deg: y_0.
            before_V: voltage before the first sample.

        Returns:
            y_0, y_1, ... [deg], shape (n,); y_k follows from v_(k-tau).
        """
        v = np.concatenate([np.full(self.delay_samples, before_V), np.asarray(voltage_V, dtype=float)])
        increments = self.increment(v[: len(v) - self.delay_samples])
        angles = np.empty(len(increments))
        angles[0] = initial_deg
        for k in range(1, len(angles)):
            moved = angles[k - 1] + increments[k]
            angles[k] = min(max(moved, self.lower_deg), self.upper_deg)
        return angles


@cache
def thesis_data() -> dict[str, Any]:
    """Content of `sdp_models.yaml`."""
    return package_yaml(__package__, "sdp_models.yaml")


def thesis_model(joint: str) -> SdpModel:
    """Model of Table 6.1 ("j1" to "j4") or Table 6.7 ("j4_linear").

    Raises:
        InputError: no such joint.
    """
    data = thesis_data()
    if joint not in data["joints"]:
        raise InputError(f"the thesis has no SDP model '{joint}'; choose {', '.join(data['joints'])}")
    entry = data["joints"][joint]
    return SdpModel(
        name=joint,
        alpha=tuple(map(float, entry["alpha"])),
        beta=tuple(map(float, entry["beta"])) if entry["law"] == "linear" else None,
        sample_s=float(data["sample"]["value"]),
        delay_samples=int(entry["delay_samples"]),
        lower_deg=float(entry["range_deg"][0]),
        upper_deg=float(entry["range_deg"][1]),
    )
