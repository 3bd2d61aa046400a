"""A measured signal, and how far a perfect model would be off from it."""

from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.identification.experiments.thinning import Blocks
from hydrolek_drake.replay.noise import noise_level

FAITHFUL = 3e-4
"""A model follows a machine to this share of a signal's range at best, however fine the sensor: a noise below it
would only give weight to what no model holds (a tenth of the best published fits of real machines)."""

SURELY = 3.0
"""Standard deviations beyond which a gauge shows more than its noise."""


@dataclass(frozen=True)
class Channel:
    """A measured signal that the model must follow.

    Attributes:
        key: `<joint>.<quantity>`.
        unit: SI unit.
        model: attribute of `Signals` that it is compared with.
        measured: NaN where the recording has no value. # (n,)
        noise: standard deviation of its noise.
        model_error: standard deviation of what the model's integration adds, sample by sample; None for
            nothing. # (n,)
        least_error: of a model at best, as what its rig states nobody described; it is told from missing physics by no
            more than what is left beyond it.
        discrepancy: what every model leaves of it, as a multiple of what it leaves of the signal that it follows best;
            1 where models reach the noise.
        timing: what a sample's uncertain moment adds where the signal moves, sample by sample; None for nothing. # (n,)
        blur: what averaging over blocks of samples adds, sample by sample; None for a recording that is kept as
            it is. # (n,)
    """

    key: str
    unit: str
    model: str
    measured: np.ndarray
    noise: float
    model_error: np.ndarray | None = None
    blur: np.ndarray | None = None
    timing: np.ndarray | None = None
    discrepancy: float = 1.0
    least_error: float = 0.0

    @property
    def measured_beyond_noise(self) -> np.ndarray:
        """What was measured; of a pressure that its noise does not tell from zero, zero. # (n,)."""
        if self.unit != "Pa":
            return self.measured
        return np.where(np.abs(self.measured) < SURELY * self.noise, 0.0, self.measured)

    @property
    def deviation(self) -> np.ndarray | float:
        """Standard deviation that the residual of a perfect model would have."""
        variance: np.ndarray | float = self.noise**2
        for error in (self.model_error, self.blur, self.timing):
            if error is not None:
                variance = variance + error**2
        return self.discrepancy * (self.noise if isinstance(variance, float) else np.sqrt(variance))

    @property
    def model_share(self) -> np.ndarray:
        """Share of the variance that is the model's error, sample by sample. # (n,)."""
        if self.model_error is None:
            return np.zeros(self.measured.size)
        return (self.discrepancy * self.model_error / self.deviation) ** 2

    @property
    def least_left(self) -> np.ndarray:
        """Squared residual that a model leaves at best, sample by sample. # (n,)."""
        return np.broadcast_to((self.least_error / self.deviation) ** 2, self.measured.shape)

    def until(self, count: int) -> "Channel":
        """Its first so many samples."""
        error, blur, timing = (
            None if v is None else v[:count] for v in (self.model_error, self.blur, self.timing)
        )
        return replace(self, measured=self.measured[:count], model_error=error, blur=blur, timing=timing)

    def timed(self, time: np.ndarray, time_error: float) -> "Channel":
        """The same signal whose samples were taken at moments that are known to a standard deviation only.

        To first order a moment that is off by dt changes a value by dt times the signal's slope (errors in variables;
        Fuller, Measurement Error Models, 1987, chapter 3): where a cylinder strikes its stop a pressure of megapascals
        rises within milliseconds, and a tenth of a millisecond is many times a sensor's noise.

        Args:
            time: of the samples [s]. # (n,)
            time_error: standard deviation [s]; nothing for 0.
        """
        if time_error == 0.0 or time.size < 2:  # one sample has no slope
            return self
        known = np.isfinite(self.measured)
        slope = np.gradient(np.interp(time, time[known], self.measured[known]), time) if known.any() else 0.0
        return replace(self, timing=np.broadcast_to(time_error * np.abs(slope), time.shape))

    def averaged(self, blocks: Blocks, floor: float) -> "Channel":
        """The same signal averaged over blocks; its noise is estimated anew and is `floor` at least."""
        means = blocks.mean(self.measured)
        noise = min(self.noise, max(noise_level(means), floor))
        timing = None if self.timing is None else blocks.mean(self.timing)
        return replace(self, measured=means, noise=noise, blur=blocks.blur(means), timing=timing)


def faithful(measured: np.ndarray) -> float:
    """Smallest deviation that counts for a signal, see `FAITHFUL`."""
    return FAITHFUL * spanned(measured)


def spanned(measured: np.ndarray) -> float:
    """Range of a signal."""
    return float(np.nanmax(measured) - np.nanmin(measured))
