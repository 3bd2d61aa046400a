"""Reach mask and edge picture: what is out of reach gives no lines, poor light does not hide them."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.edges import (
    EdgeSettings,
    canny,
    contrast_copy,
    default_settings,
    dilated,
    edge_picture,
    reach_mask,
)


def test_reach_mask_needs_a_reading_within_reach():
    settings = EdgeSettings(0.4, 0.6, 0.2, 0.5, 1.5)
    depth = np.array([[0, 499, 500, 1500, 1501]], np.uint16)
    np.testing.assert_array_equal(reach_mask(depth, settings), [[False, False, True, True, False]])


def test_contrast_copy_is_imadjust():
    """Matlab's imadjust with limits 0.2 and 0.6: (I - 0.2) / 0.4, clipped."""
    grey = np.array([[0, 51, 102, 153, 255]], np.uint8)
    np.testing.assert_array_equal(contrast_copy(grey, 0.2, 0.6), [[0, 0, 128, 255, 255]])


def test_dilation_is_two_pixels_along_both_axes():
    lines = np.zeros((5, 5), np.uint8)
    lines[2, 2] = 255
    assert dilated(lines).sum() == 4 * 255


def test_edges_lie_on_the_pipes_outline(pipe):
    colour, depth, hit = pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4)
    settings = default_settings()
    edges = edge_picture(colour, reach_mask(depth, settings), settings)
    rows = slice(50, 430)
    borders = np.flatnonzero(np.diff(hit[240].astype(int)))
    columns = np.flatnonzero(edges[rows].any(axis=0))
    assert all(np.abs(borders - column).min() <= 3 for column in columns)
    assert all((np.abs(columns - border).min() <= 2) for border in borders)
    assert edges[rows][:, columns].any(axis=1).all()  # lines without gaps


def test_what_is_out_of_reach_is_black(pipe):
    colour, depth, _ = pipe([0.0, 0.0, 3.0], [0, 1, 0], 0.05, wall=3.5)
    settings = default_settings()
    mask = reach_mask(depth, settings)
    assert not mask.any() and not edge_picture(colour, mask, settings).any()


def test_the_dark_copy_shows_edges_that_the_original_hides():
    """A dark object beside a bright lamp: its edge is a twentieth of the strongest gradient."""
    grey = np.full((100, 100), 10, np.uint8)
    grey[:, 40:60] = 25
    grey[:, 90:] = 255
    assert not canny(grey, 0.25)[:, 35:65].any()
    settings = EdgeSettings(0.12, 0.9, 0.25, 0.5, 1.5)
    colour = np.repeat(grey[..., None], 3, axis=-1)
    edges = edge_picture(colour, np.ones((100, 100), bool), settings)
    assert edges[10:90, 36:44].any(axis=1).all() and edges[10:90, 56:64].any(axis=1).all()


def test_more_sensitivity_threshold_means_fewer_edges():
    grey = np.random.default_rng(1).integers(0, 255, (200, 200)).astype(np.uint8)
    counts = [int((canny(grey, s) > 0).sum()) for s in (0.1, 0.3, 0.6, 0.9)]
    assert counts == sorted(counts, reverse=True) and counts[0] > counts[-1]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ((0.0, 0.5, 0.5, 0.4, 1.0), "low_contrast"),
        ((0.5, 1.0, 0.5, 0.4, 1.0), "high_contrast"),
        ((0.5, 0.5, float("nan"), 0.4, 1.0), "sensitivity"),
        ((0.5, 0.5, 0.5, 1.4, 1.0), "rising pair"),
    ],
)
def test_settings_that_make_no_sense_are_refused(values, message):
    with pytest.raises(InputError, match=message):
        EdgeSettings(*values)
