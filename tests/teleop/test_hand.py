"""Joints by hand: the dead-man's switch, on the simple arms."""

import time

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.hand import Hand, travel
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.trajectory import joint_speeds

HOLD = teleop_entries("manual")["hold"]
ONE = np.array([40.0, *[0.0] * 13])


@pytest.fixture
def machine():
    machine = Machine(home_posture(), realtime_rate=5.0)
    yield machine
    machine.close()


def _keep(call, seconds):
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        call()
        time.sleep(0.1 * HOLD)


def _still(machine):
    time.sleep(0.1)
    before = machine.state()
    time.sleep(0.3)
    after = machine.state()
    np.testing.assert_array_equal(after.position, before.position)
    assert not after.valves_open and after.manual == ""


def test_a_joystick_moves_its_joint_while_it_is_held(machine):
    _keep(lambda: machine.move_by_hand(deflection=ONE), 0.5)
    moved = machine.state().position - home_posture()
    assert moved[0] > np.radians(2.0) and np.abs(moved[1:]).max() == 0.0
    assert machine.state().manual == "joystick" and machine.state().valves_open
    machine.let_go()
    _still(machine)


def test_a_silent_hand_has_let_go(machine):
    machine.move_by_hand(deflection=ONE)
    time.sleep(1.2 * HOLD)
    _still(machine)
    assert machine.state().position[0] > home_posture()[0]


def test_after_a_stop_nothing_moves_before_the_hand_has_let_go(machine):
    _keep(lambda: machine.move_by_hand(deflection=ONE), 0.2)
    machine.order(Order.STOP)
    _keep(lambda: machine.move_by_hand(deflection=ONE), 0.2)
    _still(machine)
    machine.let_go()
    before = machine.state().position[0]
    _keep(lambda: machine.move_by_hand(deflection=ONE), 0.3)
    assert machine.state().position[0] > before


def test_the_sliders_are_reached_at_the_planner_s_speed(machine):
    wanted = 0.5 * home_posture()
    begin = time.monotonic()
    while np.abs(machine.state().position - wanted).max() > np.radians(0.5):
        machine.move_by_hand(towards=wanted)
        assert time.monotonic() - begin < 5.0
        time.sleep(0.02)
    fastest = np.max(np.abs(wanted - home_posture()) / joint_speeds()[0]) / 5.0
    assert time.monotonic() - begin > 0.9 * fastest
    machine.let_go()
    _still(machine)


def test_a_task_is_not_disturbed_and_begins_after_the_hand(machine, plan):
    machine.move_by_hand(deflection=np.zeros(14))
    machine.start(plan)
    assert machine.state().manual == ""
    with pytest.raises(InputError, match="abort it before you move"):
        machine.move_by_hand(deflection=ONE)
    machine.order(Order.ABORT)
    machine.let_go()
    _keep(lambda: machine.move_by_hand(deflection=ONE), 0.2)
    assert machine.state().manual == "joystick"


@pytest.mark.parametrize(
    ("wish", "message"),
    [
        ({"deflection": np.full(14, 101.0)}, "right_j1 = 101 is outside -100.0 to 100.0"),
        ({"deflection": np.full(14, np.nan)}, "right_j1 = nan"),
        ({"deflection": np.zeros(3)}, "3 deflections were sent; 14"),
        ({"towards": np.full(14, np.radians(50.0))}, "right_j1 = 50 is outside -27.0 to 40.6"),
    ],
)
def test_what_no_hand_can_want_is_refused(wish, message):
    hand = Hand()
    with pytest.raises(InputError, match=message):
        hand.move(home_posture(), wish.get("deflection"), wish.get("towards"))
    assert hand.moving() == ""


def test_a_reading_beyond_a_stop_is_where_the_sliders_begin_from_the_stop():
    hand = Hand()
    lower, _ = travel()
    hand.move(np.where(np.isfinite(lower), lower, 0.0) - 0.01, None, home_posture())
    assert (hand.step(0.0) >= np.where(np.isfinite(lower), lower, -np.inf) - 1e-12).all()


def test_wrong_numbers_are_told_to_a_blocked_hand_too():
    hand = Hand()
    hand.block()
    with pytest.raises(InputError, match="left_j7 = 200 is outside"):
        hand.move(home_posture(), np.array([0.0] * 13 + [200.0]), None)
