"""Cancelling the dead-zone: the linearised nonlinearity (6.4) and its inverse (6.5)."""

from dataclasses import dataclass

from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_data


@dataclass(frozen=True)
class InverseDeadZone:
    """Inverse dead-zone with two straight lines, figure 6.6.

    Attributes:
        slope_negative: s_n of (6.4) [deg per control sample and V].
        slope_positive: s_p.
        edge_negative_V: alpha3, lower edge of the dead-zone.
        edge_positive_V: alpha6, upper edge.
        chatter: beta of (6.5), the output below which the valve stays shut [deg per control sample].
        lowest_V: lower limit of the voltage.
        highest_V: upper limit.
    """

    slope_negative: float
    slope_positive: float
    edge_negative_V: float
    edge_positive_V: float
    chatter: float
    lowest_V: float
    highest_V: float

    def voltage(self, output: float) -> float:
        """Voltage for a controller output [deg per control sample], thesis equation (6.5).

            u / s_n + alpha3 for u < -beta, 0 for -beta <= u <= beta, u / s_p + alpha6 for u > beta

        The thesis prints u / (s_n + alpha3), which does not invert (6.4) (docs/reference/thesis_errata.md).
        """
        if output > self.chatter:
            return min(output / self.slope_positive + self.edge_positive_V, self.highest_V)
        if output < -self.chatter:
            return max(output / self.slope_negative + self.edge_negative_V, self.lowest_V)
        return 0.0

    def increment(self, voltage_V: float) -> float:
        """Linearised nonlinearity q{v} [deg per control sample], thesis equation (6.4)."""
        if voltage_V > self.edge_positive_V:
            return self.slope_positive * (voltage_V - self.edge_positive_V)
        if voltage_V < self.edge_negative_V:
            return self.slope_negative * (voltage_V - self.edge_negative_V)
        return 0.0

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest output that still changes the voltage."""
        return self.increment(self.lowest_V), self.increment(self.highest_V)


def inverse_dead_zone(model: SdpModel, limit_V: float, *, until_saturation: bool = False) -> InverseDeadZone:
    """Inverse dead-zone of an SDP model, thesis section 6.1.5.

    The slopes are those of the secants from the dead-zone's edges to v_min and v_max, where the model moves
    with 20 deg/s: s_n = q{v_min} / (v_min - alpha3), s_p = q{v_max} / (v_max - alpha6). A model that
    saturates below 20 deg/s is linearised at nine tenths of its saturation rate.

    Args:
        model: of the joint.
        limit_V: largest voltage.
        until_saturation: limit the voltages to where the joint reaches its saturation rate for all practical
            purposes, so that a controller's anti-windup knows when more output moves nothing faster.
    """
    data = thesis_data()["inverse"]
    sample, wanted = float(data["sample"]["value"]), float(data["rate"]["value"])
    share = float(data["share_of_saturation"]["value"])
    low, high = model.dead_zone_V
    slowest, fastest = model.saturation_deg_per_s
    lowest, highest = -limit_V, limit_V
    if until_saturation:
        nearly = float(data["nearly_saturated"]["value"])
        lowest, highest = model.voltage_at(nearly * slowest), model.voltage_at(nearly * fastest)
    down, up = max(-wanted, share * slowest), min(wanted, share * fastest)
    return InverseDeadZone(
        slope_negative=down * sample / (model.voltage_at(down) - low),
        slope_positive=up * sample / (model.voltage_at(up) - high),
        edge_negative_V=low,
        edge_positive_V=high,
        chatter=float(data["chatter"]["value"]),
        lowest_V=lowest,
        highest_V=highest,
    )
