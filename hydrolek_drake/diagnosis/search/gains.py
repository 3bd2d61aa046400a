"""What a further effect must bring before it is believed."""

from hydrolek_drake.identification.least_squares import Fit

GAIN_NEEDED = 12.0
"""Smallest gain (fall of the squared residuals) that is followed up: 3.5 standard deviations of one size."""

PROMISING = 0.5
"""An effect is tried if it promises this share of what it must bring: the sizes at which it was tried may be wrong."""

VISIBLE = 16.0
"""Gain at which an effect would have been seen: four standard deviations of its size."""

FIDELITY = 0.004
"""Fall of the squared residuals, as a share of the values, below which an effect is not told from what every
model leaves out: 0.2 % of the noise's rms."""


def gain_needed(fit: Fit) -> float:
    """Fall of the squared residuals that one more effect must bring.

    It is more than chance would bring, and more than what is known but roughly may leave.
    """
    return max(GAIN_NEEDED, FIDELITY * fit.counted, fit.unsure)
