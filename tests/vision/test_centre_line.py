"""Centre line against closed forms of a rectangle, snapping, and the cut across."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.vision.centre_line import centre_line


def _rectangle(angle_deg, length=200.0, width=40.0, centre=(300.0, 200.0)):
    v, u = np.mgrid[0:480, 0:640]
    angle = np.radians(angle_deg)
    x, y = u - centre[0], centre[1] - v
    along, across = x * np.cos(angle) + y * np.sin(angle), -x * np.sin(angle) + y * np.cos(angle)
    return (np.abs(along) <= length / 2) & (np.abs(across) <= width / 2)


@pytest.mark.parametrize("angle", [-80.0, -30.0, 0.0, 20.0, 60.0, 89.0])
def test_line_of_a_rectangle(angle):
    line = centre_line(_rectangle(angle))
    np.testing.assert_allclose(line.centre, [300, 200], atol=0.2)
    assert np.degrees(line.orientation) == pytest.approx(angle, abs=0.3)
    # the ellipse with a rectangle's second moments is 2/sqrt(3) times as long and as wide
    assert line.length == pytest.approx(200 * 2 / np.sqrt(3), rel=0.01)
    assert line.width == pytest.approx(40 * 2 / np.sqrt(3), rel=0.04)
    half = line.length / 2 * np.array([np.cos(line.orientation), -np.sin(line.orientation)])
    np.testing.assert_allclose(line.ends, [line.centre - half, line.centre + half])  # (5.1)


@pytest.mark.parametrize(("angle", "axis"), [(20.0, 0), (-44.0, 0), (46.0, 1), (-80.0, 1)])
def test_a_click_is_snapped_along_its_column_or_row(angle, axis):
    line = centre_line(_rectangle(angle))
    click = np.array([310.0, 190.0])
    snapped = line.snap(click)
    assert snapped[axis] == pytest.approx(click[axis])
    offset = snapped - line.centre
    assert offset[0] * line.direction()[1] - offset[1] * line.direction()[0] == pytest.approx(0, abs=1e-9)


def test_a_click_beyond_the_end_is_snapped_to_the_end():
    line = centre_line(_rectangle(0.0))
    np.testing.assert_allclose(line.snap([639.0, 200.0]), line.ends[1])


@pytest.mark.parametrize("angle", [0.0, 35.0, 90.0])
def test_the_cut_is_square_to_the_line_and_clears_the_width_on_both_sides(angle):
    line = centre_line(_rectangle(angle))
    start, end = line.cut(line.centre, 15.0)
    assert (end - start) @ line.direction() == pytest.approx(0, abs=1e-9)
    assert np.linalg.norm(end - start) == pytest.approx(line.width + 30.0)
    np.testing.assert_allclose((start + end) / 2, line.centre)


def test_nothing_selected_is_refused():
    with pytest.raises(InputError, match="nothing is selected"):
        centre_line(np.zeros((10, 10), bool))
