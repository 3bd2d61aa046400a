"""A loose pipe: it stands, goes with the hand that clasps it, falls by the law of free fall and lands on the table."""

import numpy as np
import pytest

from hydrolek_drake.workcell.loose_pipe import GRAVITY, LoosePipe, clasped
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.table import make_loose_pipe, make_table, table_under

TABLE = make_table()
STILL = (np.eye(3), np.zeros(3))
PERIOD = 0.01


def _turned(degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


def test_an_upright_pipe_stands_on_the_table_and_stays_there():
    loose = LoosePipe(make_loose_pipe(TABLE))
    assert loose.pipe.lowest() == pytest.approx(TABLE.top[2])
    assert loose.step([STILL, STILL], [False, False], TABLE, PERIOD).pipe == loose.pipe


def test_the_lowest_point_of_a_lying_and_of_a_leaning_pipe():
    assert make_pipe([0, 0, 1], [1, 0, 0], 0.04, 1.0).lowest() == pytest.approx(0.96)
    leaning = make_pipe([0, 0, 1], [1, 0, 1], 0.04, 1.0)
    assert leaning.lowest() == pytest.approx(1 - 0.54 * np.sqrt(0.5))


def test_it_goes_with_the_hand_as_one_body():
    begin = (np.eye(3), np.array([1.8, 0.0, 0.9]))
    loose = LoosePipe(make_loose_pipe(TABLE)).step([begin, STILL], [True, False], TABLE, PERIOD)
    assert loose.holder == "right"
    hand = (_turned(30.0), begin[1] + [0.1, -0.2, 0.3])
    pipe = loose.now([hand, STILL])
    before, after = loose.pipe.point - begin[1], pipe.point - hand[1]
    np.testing.assert_allclose(_turned(30.0) @ before, after, atol=1e-12)
    np.testing.assert_allclose(pipe.axis, _turned(30.0) @ [0, 0, 1], atol=1e-12)
    assert loose.step([hand, STILL], [True, False], TABLE, PERIOD) is loose  # held on


def test_let_go_it_falls_as_everything_does_and_lands_on_the_table():
    pipe = make_loose_pipe(TABLE)
    height = 0.2
    loose = LoosePipe(pipe.moved(np.eye(3), [0, 0, height]))
    count = 0
    while count == 0 or loose.falling > 0.0:
        loose = loose.step([STILL, STILL], [False, False], TABLE, PERIOD)
        count += 1
        assert count < 100
    assert count * PERIOD == pytest.approx(np.sqrt(2 * height / GRAVITY), abs=PERIOD)
    assert loose.pipe.lowest() == pytest.approx(TABLE.top[2])


def test_beside_the_table_it_falls_on_the_floor():
    loose = LoosePipe(make_loose_pipe(TABLE, point=[1.2, 0.0]))
    for _ in range(100):
        loose = loose.step([STILL, STILL], [False, False], TABLE, PERIOD)
    assert loose.pipe.lowest() == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("beside", "jaw_deg", "held"), [(0.0, 10.0, True), (0.0, 35.0, False), (0.1, 10.0, False)]
)
def test_a_gripper_without_forces_holds_what_is_between_its_closed_fingers(beside, jaw_deg, held):
    pipe = make_loose_pipe(TABLE)
    assert clasped(pipe, pipe.point + np.array([0.0, beside, 0.1]), np.radians(jaw_deg)) is held


def test_what_is_taken_for_the_table_reaches_beyond_all_points():
    table = table_under([[1.8, 0.0, 9.0], [1.9, -0.3, 9.0]], 0.5)
    assert table.top[2] == 0.5
    assert table.under([1.7, 0.1, 1.0]) and not table.under([2.2, 0.0, 1.0])
