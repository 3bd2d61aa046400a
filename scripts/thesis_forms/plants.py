"""SDP models under many controllers at once, the steps of appendix G, and what is measured of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.control.models.sdp_model import SdpModel

Array = NDArray[np.float64]

Form = dict[str, Any]
"""One form of a controller: what is varied -> its value."""

SIZE_DEG = 30.0
DURATION_S = (
    17.0  # of each of the two steps; the mean squared errors of appendix G fit it (docs/evidence/control.md)
)
MODEL_S, CONTROL_S = 0.01, 0.05
RATIO = round(CONTROL_S / MODEL_S)


@dataclass
class Plants:
    """SDP models under many controllers at once: one column a form.

    Attributes:
        model: of the joint.
        slow: whether the model itself runs at the control sample. # (n,)
        delay: in model samples. # (n,)
    """

    model: SdpModel
    slow: NDArray[np.bool_]
    delay: NDArray[np.int_]

    def __post_init__(self) -> None:
        self.angle = np.zeros(len(self.delay))
        self.line = np.zeros((int(self.delay.max()) + 2, len(self.delay)))
        self.k = 0

    def step(self, volts: Array) -> Array:
        """One model sample: angles before it [deg]."""
        before = self.angle
        self.line[self.k % len(self.line)] = volts
        past = self.k + 1 - self.delay
        arriving = np.where(past >= 0, self.line[past % len(self.line), np.arange(len(past))], 0.0)
        moved = self.model.increment(arriving)
        if self.slow.any():
            due = (self.k + 1) % RATIO == 0
            held = self.line[(past + 1 - RATIO) % len(self.line), np.arange(len(past))]
            sampled = np.where(past + 1 - RATIO >= 0, held, 0.0)
            moved = np.where(self.slow, RATIO * self.model.increment(sampled) if due else 0.0, moved)
        self.angle = np.clip(before + moved, self.model.lower_deg, self.model.upper_deg)
        self.k += 1
        return before


def measures(angles: Array, target: float) -> Array:
    """Rise time [s] and overshoot [%] of each form, against set point and final value, shape (2, 2, n)."""
    found = []
    for end in (np.full(angles.shape[1], target), angles[-1]):
        share = angles / np.where(end == 0.0, np.nan, end)
        times = []
        for level in (0.1, 0.9):
            above = share >= level
            k = above.argmax(axis=0)
            columns = np.arange(len(k))
            upper, lower = share[k, columns], share[np.maximum(k - 1, 0), columns]
            with np.errstate(divide="ignore", invalid="ignore"):
                part = np.where(k > 0, (level - lower) / (upper - lower), 1.0)
            times.append(np.where(above.any(axis=0), (k - 1 + part) * MODEL_S, np.nan))
        peak = np.nanmax(np.where(np.isfinite(share), share, -np.inf), axis=0)
        found.append([times[1] - times[0], np.maximum(0.0, 100.0 * (peak - 1.0))])
    return np.array(found)
