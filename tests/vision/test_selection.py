"""One click selects one object, or says why it cannot."""

import numpy as np
import pytest
from casting import cast_crossing

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import Fill, fill_between_lines, overlay, perimeter, select_object
from hydrolek_drake.vision.snapshot import take_snapshot


def _snapshot(frame):
    return take_snapshot(frame[0], frame[1], recorded_camera(), default_settings())


def _overlap(a, b):
    return (a & b).sum() / (a | b).sum()


@pytest.mark.parametrize("fill", list(Fill))
@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 0, 0), (1, 1, 0), (0.3, 1, 0.4)])
def test_a_pipe_before_a_wall_is_selected_by_one_click(pipe, axis, fill):
    frame = pipe([0.0, 0.0, 1.0], axis, 0.05, wall=1.4, noise=0.0015)
    assert _overlap(select_object(_snapshot(frame), (320, 240), fill).mask, frame[2]) > 0.9


def test_a_pipe_in_the_dark_is_still_selected_by_its_surface(pipe):
    frame = pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4, brightness=0.02, noise=0.0015)
    assert _overlap(select_object(_snapshot(frame), (320, 240)).mask, frame[2]) > 0.9


def test_the_nearer_of_two_crossing_pipes_is_selected_alone(pipe):
    near, far = pipe([0.0, 0.0, 0.9], [0, 1, 0], 0.04), pipe([0.0, 0.0, 1.2], [1, 0, 0], 0.04)
    depth = np.where(near[2], near[1], far[1])
    colour = np.where(near[2][..., None], near[0], far[0])
    selected = select_object(_snapshot((colour, depth)), (320, 100)).mask
    assert _overlap(selected, near[2]) > 0.9


def test_what_goes_on_beyond_a_nearer_pipe_is_one_object_and_sure():
    colour, depth, left, right = cast_crossing(0.0)
    for u in (100, 540):
        selection = select_object(_snapshot((colour, depth)), (u, 240))
        assert _overlap(selection.mask, left | right) > 0.9
        assert not selection.unsure and selection.warning == ""


def test_what_stands_a_hand_farther_beyond_a_nearer_pipe_is_another_object_and_sure():
    colour, depth, left, right = cast_crossing(0.15)
    for u, half in ((100, left), (540, right)):
        selection = select_object(_snapshot((colour, depth)), (u, 240))
        assert _overlap(selection.mask, half) > 0.9
        assert not selection.unsure


def test_where_it_is_unsure_it_says_so_and_offers_the_other():
    """Set back by 10 mm, twice what a Kinect's depth is off there, it may be one pipe or two."""
    colour, depth, left, right = cast_crossing(0.01)
    selection = select_object(_snapshot((colour, depth)), (100, 240))
    assert selection.unsure and selection.agreement < 1.0
    assert f"{100 * selection.agreement:.0f} % of the tries agree" in selection.warning
    both = [selection, selection.next()]
    overlaps = sorted(_overlap(each.mask, left) for each in both)
    assert overlaps[0] < 0.6 and overlaps[1] > 0.9
    assert max(_overlap(each.mask, left | right) for each in both) > 0.9
    again = both[1].next()
    np.testing.assert_array_equal(again.mask, selection.mask)


def test_the_next_of_a_sure_object_is_itself(pipe):
    selection = select_object(
        _snapshot(pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4, noise=0.0015)), (320, 240)
    )
    assert not selection.unsure and selection.next() is selection


def test_fill_stops_at_lines_and_leaves_them_out():
    edges = np.zeros((50, 50), np.uint8)
    edges[10, 10:41] = edges[40, 10:41] = edges[10:41, 10] = edges[10:41, 40] = 255
    filled = fill_between_lines(edges, np.ones((50, 50), bool), (25, 25))
    expected = np.zeros((50, 50), bool)
    expected[11:40, 11:40] = True
    np.testing.assert_array_equal(filled, expected)


def test_perimeter_is_red_on_the_colour_picture():
    selected = np.zeros((50, 50), bool)
    selected[10:30, 10:30] = True
    picture = overlay(np.full((50, 50, 3), 100, np.uint8), selected)
    red = (picture == (0, 0, 255)).all(axis=-1)
    np.testing.assert_array_equal(red, perimeter(selected) > 0)
    assert red[10, 15] and red[15, 10] and not red[20, 20] and not red[5, 5]


@pytest.mark.parametrize(
    ("click", "fill", "message"),
    [
        ((-5, 10), Fill.SURFACES, "outside the picture"),
        ((700, 10), Fill.EDGES, "outside the picture"),
        ((100, 100), Fill.SURFACES, "on a wall, floor or table"),
    ],
)
def test_a_click_beside_the_object_says_what_is_wrong(pipe, click, fill, message):
    snapshot = _snapshot(pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4))
    with pytest.raises(InputError, match=message):
        select_object(snapshot, click, fill)


@pytest.mark.parametrize("fill", list(Fill))
def test_a_click_on_nothing_says_so(pipe, fill):
    snapshot = _snapshot(pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05))
    with pytest.raises(InputError, match="nothing within reach"):
        select_object(snapshot, (100, 100), fill)


def test_a_click_on_a_line_says_so():
    edges = np.full((5, 5), 255, np.uint8)
    with pytest.raises(InputError, match="on a line"):
        fill_between_lines(edges, np.ones((5, 5), bool), (2, 2))


def test_a_click_in_the_gap_between_two_pipes_is_on_what_is_behind_them(pipe):
    left, right = (pipe([x, 0.0, 1.0], [0, 1, 0], 0.04, wall=1.4) for x in (-0.08, 0.08))
    both = left[2] | right[2]
    depth = np.where(left[2], left[1], right[1])
    colour = np.where(left[2][..., None], left[0], right[0])
    assert not both[240, 319] and both[240, 260] and both[240, 380]
    with pytest.raises(InputError, match=r"\(319, 240\) is on a wall, floor or table"):
        select_object(_snapshot((colour, depth)), (319, 240))


def test_a_click_where_the_depth_has_no_surface_is_between_objects(pipe):
    colour, depth, _ = pipe([0.0, 0.0, 1.0], [0, 1, 0], 0.05, wall=1.4)
    rows, columns = np.mgrid[100:140, 100:140]
    depth[100:140, 100:140] = np.where((rows + columns) % 2, 800, 1000)  # edges of two things, seen at once
    with pytest.raises(InputError, match=r"\(120, 120\) is between objects; click further inside"):
        select_object(_snapshot((colour, depth)), (120, 120))
