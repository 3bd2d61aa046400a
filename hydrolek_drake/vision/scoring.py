"""How well one click selects an object, against labelled frames, and whether it says when it is unsure."""

import time
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.edges import EdgeSettings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.selection import Fill, Mask, Snapshot, select_object
from hydrolek_drake.vision.snapshot import take_snapshot

_CLEAR_OF_THE_RIM = 3  # px that a random click keeps from the object's outline


@dataclass(frozen=True)
class ClickScore:
    """One click.

    Attributes:
        overlap: Intersection over union of what was selected with the object; 0 if the click was refused.
        best: The largest of this and of the alternatives that were offered.
        unsure: Whether there was a warning.
        refused: Whether the click was refused, with a reason.
        seconds: Processor time of all threads together.
    """

    overlap: float
    best: float
    unsure: bool
    refused: bool
    seconds: float


@dataclass(frozen=True)
class ObjectScore:
    """One object of one frame.

    Attributes:
        frame: Name of the frame.
        number: Number of the object in the labels, without its parts' last digit.
        middle: A click in its middle.
        anywhere: Random clicks in it.
    """

    frame: str
    number: int
    middle: ClickScore
    anywhere: tuple[ClickScore, ...]

    @property
    def clicks(self) -> tuple[ClickScore, ...]:
        """All clicks, the one in the middle first."""
        return (self.middle, *self.anywhere)

    @property
    def mean_anywhere(self) -> float:
        """Mean overlap of the random clicks."""
        return float(np.mean([click.overlap for click in self.anywhere]))


def score_frame(
    frame: Frame,
    labels: NDArray[np.uint8],
    settings: EdgeSettings,
    generator: np.random.Generator,
    *,
    fill: Fill = Fill.SURFACES,
    clicks: int = 20,
    least: int = 1,
) -> tuple[list[ObjectScore], float]:
    """Score every object of a labelled frame.

    Args:
        frame: The frame.
        labels: 10, 20, 30, ... for objects and 11, 21, 31, ... for further parts of the same, less for none; shape
            (h, w).
        settings: The sliders.
        generator: For the random clicks.
        fill: What the flood fill stops at.
        clicks: Random clicks for each object.
        least: Pixels of the smallest object that counts; one without room for a click clear of its rim does not.

    Returns:
        Scores, and the processor's seconds from pictures to snapshot, of all threads together.
    """
    begin = time.process_time()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, settings)
    seconds = time.process_time() - begin
    scores = []
    for number in sorted({int(n) // 10 for n in np.unique(labels)} - {0}):
        wanted = labels // 10 == number
        inside = cv2.distanceTransform(wanted.astype(np.uint8), cv2.DIST_L2, 5)
        rows, columns = np.nonzero(inside > _CLEAR_OF_THE_RIM)
        if np.count_nonzero(wanted) < least or not len(rows):
            continue
        row, column = np.unravel_index(inside.argmax(), inside.shape)
        chosen = generator.integers(0, len(rows), clicks)
        pixels = [(column, row), *zip(columns[chosen], rows[chosen], strict=True)]
        found = [score_click(snapshot, (float(u), float(v)), wanted, fill) for u, v in pixels]
        scores.append(ObjectScore(frame.name, number, found[0], tuple(found[1:])))
    return scores, seconds


def score_click(snapshot: Snapshot, pixel: tuple[float, float], wanted: Mask, fill: Fill) -> ClickScore:
    """One click, against the object that is wanted."""
    begin = time.process_time()
    try:
        selection = select_object(snapshot, pixel, fill)
    except InputError:
        return ClickScore(0.0, 0.0, False, True, time.process_time() - begin)
    seconds = time.process_time() - begin
    overlap, *others = (_overlap(mask, wanted) for mask in (selection.mask, *selection.alternatives))
    return ClickScore(overlap, max(overlap, *others, 0.0), selection.unsure, False, seconds)


def _overlap(a: Mask, b: Mask) -> float:
    return float((a & b).sum() / (a | b).sum())
