"""Proportional-integral-plus control in feedback form, sections 6.2.2 to 6.2.5."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.design import PipGains
from hydrolek_drake.control.laws.law import Array, InputElement, clipped


@dataclass(frozen=True)
class PipLaw:
    """State-variable feedback of the non-minimal state, thesis equations (6.16), (6.17).

        u_k = -f_0 y_k - f_1 y_(k-1) - ... - g_1 u_(k-1) - g_2 u_(k-2) - ... + k_I z_k
        z_k = z_(k-1) + (yd_k - y_k)

    With `anti_windup`, z_k is put back to where the limited output would have come from, which is the
    incremental form of the law with its past outputs limited.

    Attributes:
        gains: f, g, k_I.
        element: output to voltage.
        anti_windup: false for the thesis's form.
    """

    gains: PipGains
    element: InputElement
    anti_windup: bool = True

    @property
    def size(self) -> int:
        """z, past outputs, past angles."""
        return 1 + len(self.gains.g) + len(self.gains.f) - 1

    def initial(self, measured_deg: float) -> Array:
        """All past angles as now, past outputs zero, and the z that balances them."""
        angles = [measured_deg] * (len(self.gains.f) - 1)
        balance = sum(self.gains.f) * measured_deg / self.gains.k_i
        return np.array([balance, *[0.0] * len(self.gains.g), *angles])

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        m = len(self.gains.g)
        z = float(state[0]) + set_point_deg - measured_deg
        outputs, angles = state[1 : 1 + m], np.concatenate([[measured_deg], state[1 + m :]])
        wanted = float(self.gains.k_i * z - np.dot(self.gains.f, angles) - np.dot(self.gains.g, outputs))
        output = wanted
        if self.anti_windup:
            output = clipped(wanted, self.element.limits)
            z += (output - wanted) / self.gains.k_i
        past = np.concatenate([[output], outputs])[:m]
        return np.concatenate([[z], past, angles[:-1]]), output, self.element.voltage(output)
