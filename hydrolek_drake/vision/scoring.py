"""How well one click selects an object, against labelled frames."""

import time
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.edges import EdgeSettings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.selection import Fill, select_object
from hydrolek_drake.vision.snapshot import take_snapshot

_CLEAR_OF_THE_RIM = 3  # px that a random click keeps from the object's outline


@dataclass(frozen=True)
class ObjectScore:
    """One object of one frame.

    Attributes:
        frame: Name of the frame.
        number: Number of the object in the labels, without its parts' last digit.
        middle: Intersection over union from a click in its middle.
        anywhere: Mean of the same over random clicks in it; a refused click counts 0.
    """

    frame: str
    number: int
    middle: float
    anywhere: float


def score_frame(
    frame: Frame,
    labels: NDArray[np.uint8],
    settings: EdgeSettings,
    generator: np.random.Generator,
    *,
    fill: Fill = Fill.SURFACES,
    clicks: int = 20,
) -> tuple[list[ObjectScore], float]:
    """Score every object of a labelled frame.

    Args:
        frame: The frame.
        labels: 20, 30, ... for objects and 21, 31, ... for further parts of the same, less for none; shape (h, w).
        settings: The sliders.
        generator: For the random clicks.
        fill: What the flood fill stops at.
        clicks: Random clicks for each object.

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
        row, column = np.unravel_index(inside.argmax(), inside.shape)
        rows, columns = np.nonzero(inside > _CLEAR_OF_THE_RIM)
        chosen = generator.integers(0, len(rows), clicks)
        overlaps = []
        for click in [(column, row), *zip(columns[chosen], rows[chosen], strict=True)]:
            try:
                selected = select_object(snapshot, (float(click[0]), float(click[1])), fill)
            except InputError:
                overlaps.append(0.0)
                continue
            overlaps.append(float((selected & wanted).sum() / (selected | wanted).sum()))
        scores.append(ObjectScore(frame.name, number, overlaps[0], float(np.mean(overlaps[1:]))))
    return scores, seconds
