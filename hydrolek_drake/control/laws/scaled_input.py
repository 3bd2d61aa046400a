"""The laboratory's earlier way round the dead-zone: scaling of a signal in percent, (6.7) and (6.8)."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ScaledInput:
    """Scaling of one joint, Table 6.3.

    Attributes:
        dead_negative_V: D_n.
        dead_positive_V: D_p.
        lowest_V: S_n.
        highest_V: S_p.
        factor_negative: f_n [V per percent].
        factor_positive: f_p.
        full: largest signal [percent].
    """

    dead_negative_V: float
    dead_positive_V: float
    lowest_V: float
    highest_V: float
    factor_negative: float
    factor_positive: float
    full: float

    def voltage(self, output: float) -> float:
        """Voltage for a controller output in percent, thesis equations (6.7), (6.8).

            D_p + U f_p for U > 0, 0 for U = 0, D_n + U f_n for U < 0, then limited to S_n .. S_p

        The thesis prints D_n - U f_n, which would reduce the voltage as U falls (docs/reference/thesis_errata.md).
        """
        signal = min(max(output, -self.full), self.full)
        voltage = 0.0
        if signal > 0.0:
            voltage = self.dead_positive_V + signal * self.factor_positive
        elif signal < 0.0:
            voltage = self.dead_negative_V + signal * self.factor_negative
        return min(max(voltage, self.lowest_V), self.highest_V)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest signal."""
        return -self.full, self.full


@dataclass(frozen=True)
class DirectInput:
    """No scaling: the controller's output is the voltage (section 6.2.3).

    Attributes:
        limit_V: largest voltage.
    """

    limit_V: float

    def voltage(self, output: float) -> float:
        """The output, limited."""
        return min(max(output, -self.limit_V), self.limit_V)

    @property
    def limits(self) -> tuple[float, float]:
        """Lowest and highest output."""
        return -self.limit_V, self.limit_V
