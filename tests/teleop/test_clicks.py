"""Clicks into one frame where it is unsure what the object is."""

import numpy as np
import pytest
from casting import cast_crossing

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.target_selection.clicks import Clicks, Task, Wanted
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.frames import Frame
from hydrolek_drake.vision.selection import Fill

UNSURE, SURE = 0.01, 0.15  # m that the right half of the pipe is set back


def _clicks(shift):
    colour, depth, _, _ = cast_crossing(shift)
    return Clicks(Frame(colour, depth, recorded_camera(), "cast"), Task.CUT, default_settings())


def _shown(clicks):
    """Which pixels are shown as the object."""
    return (clicks.pictures()["edges"] == 255).all(axis=-1)


def test_an_unsure_object_is_told_and_a_click_at_its_place_shows_the_other():
    clicks = _clicks(UNSURE)
    clicks.click(100, 240, Fill.SURFACES)
    first = _shown(clicks)
    assert clicks.unsure() and "Unsure of this outline" in clicks.told()
    assert "click at the same place shows another" in clicks.told()
    clicks.click(103, 244, Fill.SURFACES)
    other = _shown(clicks)
    assert clicks.wanted() is Wanted.GRASP and clicks.unsure()
    assert (first & other).sum() / (first | other).sum() < 0.6
    clicks.click(100, 240, Fill.SURFACES)
    np.testing.assert_array_equal(_shown(clicks), first)


def test_a_click_elsewhere_on_an_unsure_object_is_the_grasp_and_ends_the_warning():
    clicks = _clicks(UNSURE)
    clicks.click(100, 240, Fill.SURFACES)
    clicks.click(160, 240, Fill.SURFACES)
    assert clicks.wanted() is Wanted.CUT and not clicks.unsure() and clicks.told() == ""
    assert clicks.back() and clicks.unsure() and clicks.told() != ""
    clicks.click(160, 240, Fill.SURFACES)
    clicks.click(210, 240, Fill.SURFACES)
    assert clicks.wanted() is Wanted.NOTHING and clicks.told() == "Pipe of 100 mm."


def test_a_sure_object_may_be_grasped_where_it_was_clicked():
    clicks = _clicks(SURE)
    clicks.click(100, 240, Fill.SURFACES)
    assert not clicks.unsure() and clicks.told() == ""
    clicks.click(100, 240, Fill.SURFACES)
    assert clicks.wanted() is Wanted.CUT


def test_another_object_is_not_kept_from_before():
    clicks = _clicks(UNSURE)
    clicks.click(100, 240, Fill.SURFACES)
    assert clicks.back() and not clicks.unsure() and clicks.told() == ""
    with pytest.raises(InputError, match="on a wall"):
        clicks.click(100, 40, Fill.SURFACES)
    assert clicks.wanted() is Wanted.OBJECT
