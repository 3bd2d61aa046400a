"""Proportional-integral-plus control in forward-path form, section 6.2.7."""

from dataclasses import dataclass

import numpy as np

from hydrolek_drake.control.laws.law import Array, InputElement, clipped


@dataclass(frozen=True)
class ForwardPathLaw:
    """A filter on the summed error, Table 6.8 and figure 6.24.

        den(z^-1) u_k = num(z^-1) s_k

    where s is the sum of errors up to now, or with `delayed_sum` up to the sample before: a forward-Euler
    integrator, which is the form that gives Table G.4 (docs/evidence/control.md). num = k_I (1 - z^-1) cancels the
    sum's pole, so the law acts on the error itself and leaves a steady error inside the chatter band.

    Past outputs enter limited, which is all the anti-windup that this form needs.

    Attributes:
        num: of the filter; num[0] weighs the newest sum.
        den: of the filter; den[0] is 1.
        element: output to voltage.
        delayed_sum: as the thesis's simulation did.
    """

    num: tuple[float, ...]
    den: tuple[float, ...]
    element: InputElement
    delayed_sum: bool = True

    @property
    def size(self) -> int:
        """Sums, newest first, then past outputs."""
        return len(self.num) + (1 if self.delayed_sum else 0) + len(self.den) - 1

    def initial(self, measured_deg: float) -> Array:
        """Nothing summed, no past outputs."""
        return np.zeros(self.size)

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`."""
        kept = self.size - (len(self.den) - 1)
        sums = np.concatenate([[state[0] + set_point_deg - measured_deg], state[:kept]])[:kept]
        used = sums[1:] if self.delayed_sum else sums
        past = state[kept:]
        wanted = float(np.dot(self.num, used) - np.dot(self.den[1:], past))
        output = clipped(wanted, self.element.limits)
        return (
            np.concatenate([sums, np.concatenate([[output], past])[: len(past)]]),
            output,
            self.element.voltage(output),
        )
