"""Proportional-integral control with scaled input, section 6.2.1."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.laws.law import Array, InputElement, clipped


@dataclass(frozen=True)
class PiLaw:
    """Proportional-integral law, thesis equation (6.6).

        U = K_P e + K_I (integral of e dt), e = set point - angle

    The integral is summed once a sample. With `anti_windup` the sum stands still while the output is at its
    limit and the error would drive it further.

    Attributes:
        k_p: K_P [output per deg].
        k_i: K_I [output per deg and s].
        sample_s: sample time.
        element: output to voltage.
        anti_windup: false for the thesis's form.
    """

    k_p: float
    k_i: float
    sample_s: float
    element: InputElement
    anti_windup: bool = True

    @property
    def size(self) -> int:
        """The integral."""
        return 1

    def initial(self, measured_deg: float) -> Array:
        """An empty integral."""
        return np.zeros(1)

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        error = set_point_deg - measured_deg
        integral = float(state[0]) + self.k_i * self.sample_s * error
        wanted = self.k_p * error + integral
        output = clipped(wanted, self.element.limits)
        if self.anti_windup and (wanted - output) * error > 0.0:
            integral = float(state[0])
            output = clipped(self.k_p * error + integral, self.element.limits)
        return np.array([integral]), output, self.element.voltage(output)
