"""Proportional-integral-derivative control with scaled input, as industry uses it."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.laws.law import Array, InputElement, clipped


@dataclass(frozen=True)
class PidLaw:
    """Discrete PID with the derivative on the angle, filtered, so that a step of the set point does not kick.

        U = K_P e + I - K_D d,  I += K_I T e,  d += T / (T_f + T) ((y - y_before) / T - d)

    (Astrom and Hagglund, Advanced PID Control, 2006, chapter 3.) The integral stands still while the output
    is at its limit and the error would drive it further.

    Attributes:
        k_p: [output per deg].
        k_i: [output per deg and s].
        k_d: [output s per deg].
        filter_s: T_f, time constant of the derivative's filter.
        sample_s: T.
        element: output to voltage.
    """

    k_p: float
    k_i: float
    k_d: float
    filter_s: float
    sample_s: float
    element: InputElement

    @property
    def size(self) -> int:
        """Integral, last angle, filtered derivative."""
        return 3

    def initial(self, measured_deg: float) -> Array:
        """An empty integral and a joint at rest."""
        return np.array([0.0, measured_deg, 0.0])

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        before, last, slope = map(float, state)
        error = set_point_deg - measured_deg
        share = self.sample_s / (self.filter_s + self.sample_s)
        slope += share * ((measured_deg - last) / self.sample_s - slope)
        integral = before + self.k_i * self.sample_s * error
        wanted = self.k_p * error + integral - self.k_d * slope
        output = clipped(wanted, self.element.limits)
        if (wanted - output) * error > 0.0:
            integral = before
            output = clipped(self.k_p * error + integral - self.k_d * slope, self.element.limits)
        return np.array([integral, measured_deg, slope]), output, self.element.voltage(output)
