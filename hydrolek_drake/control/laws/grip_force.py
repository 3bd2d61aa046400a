"""Split-range control of a gripper's force, thesis section 3.2."""

from dataclasses import dataclass
from functools import cache
from math import isfinite
from typing import Any

import numpy as np

from hydrolek_drake.control.laws.law import Array, InputElement
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.yaml_files import package_yaml

_INTEGRAL, _HOLDING, _FORCE, _SIZE = 0, 1, 2, 3


@dataclass(frozen=True)
class Range:
    """Gains of one of the two ranges.

    Attributes:
        k_p: [percent per N].
        k_i: [percent per N and s].
        ahead_s: how far the force is seen ahead: the derivative's time, K_D = K_P times this.
        most: largest output [percent].
    """

    k_p: float
    k_i: float
    ahead_s: float
    most: float


@dataclass(frozen=True)
class GripForceLaw:
    """Force of a gripper by one output for both directions of its valve, with two sets of gains.

        U = K_P (e - T_D dF/dt) + K_I (integral of e dt), e = set point - F

    with high gains up to a threshold of the force and low ones beyond it, since a jaw that meets an object makes the
    force leap (thesis 3.2). A positive U closes the jaw, a negative one opens it; the element covers the dead-zone of
    either direction. Where e - T_D dF/dt, the error when what is sent now acts, is within the tolerance, the valve is
    shut and the trapped oil holds. A set point or force that is not a number closes the valve.

    Attributes:
        approach: gains below the threshold.
        hold: gains beyond it.
        threshold_N: of the force.
        tolerance_N: within which the valve is shut.
        closing: sign of the element's output that closes the jaw.
        sample_s: sample time.
        element: output to voltage.
    """

    approach: Range
    hold: Range
    threshold_N: float
    tolerance_N: float
    closing: float
    sample_s: float
    element: InputElement

    @property
    def size(self) -> int:
        """The integral, which range it belongs to, and the last force."""
        return _SIZE

    def initial(self, measured: float) -> Array:
        """Nothing summed."""
        return np.array([0.0, 0.0, measured if isfinite(measured) else 0.0])

    def step(self, state: Array, set_point: float, measured: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; set point and measurement are forces [N], the output is a signal [percent]."""
        if not (isfinite(set_point) and isfinite(measured)):
            return self.initial(measured), 0.0, 0.0
        holding = measured >= self.threshold_N
        gains = self.hold if holding else self.approach
        integral = float(state[_INTEGRAL]) if bool(state[_HOLDING]) == holding else 0.0
        error = set_point - measured
        ahead = error - gains.ahead_s * (measured - float(state[_FORCE])) / self.sample_s
        if abs(ahead) <= self.tolerance_N:
            return np.array([0.0, float(holding), measured]), 0.0, 0.0
        grown = integral + gains.k_i * self.sample_s * error
        wanted = gains.k_p * ahead + grown
        output = min(max(wanted, -gains.most), gains.most)
        if (wanted - output) * error <= 0.0:  # at its limit the integral stands still
            integral = grown
        return (
            np.array([integral, float(holding), measured]),
            output,
            self.element.voltage(self.closing * output),
        )


@cache
def _data() -> dict[str, Any]:
    return package_yaml(__package__, "grip_force.yaml")


def grip_force_law(element: InputElement, *, closing: float) -> GripForceLaw:
    """The law with the numbers of `grip_force.yaml`.

    Args:
        element: signal in percent to voltage of the jaw's valve.
        closing: 1 if positive signals close the jaw, -1 if negative ones do.
    """
    data = _data()
    approach, hold = (
        Range(*(float(data[name][key]["value"]) for key in ("k_p", "k_i", "ahead", "most")))
        for name in ("approach", "hold")
    )
    return GripForceLaw(
        approach, hold, float(data["threshold"]["value"]), float(data["tolerance"]["value"]),
        closing, sample_s(), element,
    )  # fmt: skip
