"""Edge picture of what is within reach: thesis sections 5.2.2 and 5.2.3."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.configuration import kinect_entries

Bytes = NDArray[np.uint8]
Depth = NDArray[np.uint16]


@dataclass(frozen=True)
class EdgeSettings:
    """What the operator's three sliders set, each between 0 and 1, and what is within reach.

    Attributes:
        low_contrast: Grey levels up to this share of white are spread over the whole scale: the dark copy.
        high_contrast: Grey levels from this share of white on are spread over the whole scale: the bright copy.
        sensitivity: Share of the strongest gradient that an edge needs; more ignores markings.
        nearest: Depth in m from which on the arms reach.
        farthest: Depth in m up to which the arms reach.
    """

    low_contrast: float
    high_contrast: float
    sensitivity: float
    nearest: float
    farthest: float

    def __post_init__(self) -> None:
        for name in ("low_contrast", "high_contrast", "sensitivity"):
            value = getattr(self, name)
            if not 0.0 < value < 1.0:
                raise InputError(f"{name} is {value}; use a number between 0 and 1")
        if not 0.0 <= self.nearest < self.farthest:
            raise InputError(f"reach is from {self.nearest} to {self.farthest} m; use a rising pair")


def default_settings() -> EdgeSettings:
    """The sliders where they stand at first, from `kinect.yaml`."""
    values = kinect_entries("edges")
    names = ("low_contrast", "high_contrast", "sensitivity", "nearest", "farthest")
    return EdgeSettings(**{name: values[name] for name in names})


def reach_mask(depth: Depth, settings: EdgeSettings) -> NDArray[np.bool_]:
    """Where there is a depth reading and it is within reach.

    Args:
        depth: In mm, 0 for no reading, shape (h, w).
        settings: Its `nearest` and `farthest` are used.
    """
    return (depth >= 1e3 * settings.nearest) & (depth <= 1e3 * settings.farthest) & (depth > 0)


def contrast_copy(grey: Bytes, low: float, high: float) -> Bytes:
    """Grey levels from `low` to `high` (shares of white) spread over the whole scale, the rest clipped."""
    scale = 1.0 / (high - low)
    levels = np.clip((np.arange(256) / 255.0 - low) * scale, 0.0, 1.0)
    return cv2.LUT(grey, (255.0 * levels).round().astype(np.uint8))


def canny(grey: Bytes, sensitivity: float) -> Bytes:
    """Canny edges with the thresholds relative to the strongest gradient, as Matlab's `edge` has them.

    Args:
        grey: Shape (h, w).
        sensitivity: Strong threshold over the largest gradient, between 0 and 1.

    Returns:
        255 on edges, else 0, shape (h, w).
    """
    values = kinect_entries("edges")
    smooth = cv2.GaussianBlur(grey, (0, 0), values["blur"])
    across, down = cv2.Sobel(smooth, cv2.CV_16S, 1, 0), cv2.Sobel(smooth, cv2.CV_16S, 0, 1)
    largest = max(max(abs(extreme) for extreme in cv2.minMaxLoc(g)[:2]) for g in (across, down))
    if largest == 0.0:
        return np.zeros_like(grey)
    strong = sensitivity * largest
    return cv2.Canny(across, down, values["weak_share"] * strong, strong, L2gradient=True)


def edge_picture(colour: Bytes, mask: NDArray[np.bool_], settings: EdgeSettings) -> Bytes:
    """Edges of the original and of three contrast copies, combined and dilated along lines.

    Args:
        colour: Blue, green, red, shape (h, w, 3).
        mask: What is within reach; the rest is black before the edges are sought, as in the thesis.
        settings: The sliders.

    Returns:
        255 on edges, else 0, shape (h, w).
    """
    values = kinect_entries("edges")
    grey = cv2.cvtColor(colour, cv2.COLOR_BGR2GRAY)
    grey[~mask] = 0
    copies = (
        grey,
        contrast_copy(grey, 0.0, settings.low_contrast),
        contrast_copy(grey, settings.high_contrast, 1.0),
        contrast_copy(grey, values["preset_low"], values["preset_high"]),
    )
    combined = np.zeros_like(grey)
    for copy in copies:
        combined |= canny(copy, settings.sensitivity)
    return dilated(combined)


def dilated(lines: Bytes) -> Bytes:
    """Lines widened by a horizontal and a vertical line of 2 px, which closes gaps of one pixel (5.2.3)."""
    wide = cv2.dilate(lines, np.ones((1, 2), np.uint8))
    return cv2.dilate(wide, np.ones((2, 1), np.uint8))
