"""One click against the labels of real frames, with the sliders as they stand at first."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.frames import FolderSource, Frame
from hydrolek_drake.vision.scoring import score_frame

SHARED = Path(__file__).parents[2].parent / "shared" / "rgbd"


def test_score_is_the_intersection_over_the_union(pipe):
    """A label that is twice the pipe's width overlaps it by half."""
    colour, depth, hit = pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4)
    columns = np.flatnonzero(hit[240])
    labels = np.zeros((480, 640), np.uint8)
    labels[:, columns.min() : columns.min() + 2 * len(columns)] = 20
    frame = Frame(colour, depth, recorded_camera(), "cast")
    scores, seconds = score_frame(frame, labels, default_settings(), np.random.default_rng(1), clicks=5)
    assert len(scores) == 1 and scores[0].number == 2
    assert max(click.overlap for click in scores[0].clicks) <= 0.55 and seconds > 0


@pytest.mark.shared_recordings
@pytest.mark.skipif(not SHARED.is_dir(), reason="needs the Kinect frames that are kept beside the project")
def test_one_click_selects_real_objects():
    """Required: mean intersection over union 0.85 with default sliders."""
    source, scores = FolderSource(SHARED), []
    for name in source.names:
        labels = cv2.imread(str(SHARED / f"{name}_label.png"), cv2.IMREAD_UNCHANGED)
        found, _ = score_frame(
            source.named(name), labels, default_settings(), np.random.default_rng(1), clicks=5
        )
        scores += found
    assert len(scores) == 26
    assert np.mean([score.middle.overlap for score in scores]) > 0.85
    assert np.mean([score.mean_anywhere for score in scores]) > 0.85
