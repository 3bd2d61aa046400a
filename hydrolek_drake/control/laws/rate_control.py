"""Joystick rate control: what operators have today. The stick's deflection sets the valve, nothing is fed back."""

from dataclasses import dataclass

from hydrolek_drake.control.laws.law import Array, InputElement, WithoutState


@dataclass(frozen=True)
class RateLaw(WithoutState):
    """Deflection of the joystick [percent] to voltage through a scaling such as Table 6.3's.

    The set point of this law is the deflection. It stops at the ends of the joint's range: a deflection that
    would drive the joint further out closes the valve.

    Attributes:
        element: deflection to voltage.
        idle: deflections up to this close the valve [percent].
        lower_deg: end of the range.
        upper_deg: the other end.
    """

    element: InputElement
    idle: float
    lower_deg: float
    upper_deg: float

    def step(self, state: Array, set_point_deg: float, measured_deg: float) -> tuple[Array, float, float]:
        """See `ControlLaw.step`; `set_point_deg` is the deflection in percent."""
        low, high = self.element.limits
        deflection = min(max(set_point_deg, low), high)
        outward = (deflection > 0.0 and measured_deg >= self.upper_deg) or (
            deflection < 0.0 and measured_deg <= self.lower_deg
        )
        if abs(deflection) <= self.idle or outward:
            deflection = 0.0
        return state.copy(), deflection, self.element.voltage(deflection)
