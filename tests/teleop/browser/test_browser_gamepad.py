"""A gamepad in a real browser, by a stand-in for `navigator.getGamepads`: its dead-man's switch, and what ends it."""

import time

import numpy as np
import pytest

from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

HOLD = teleop_entries("manual")["hold"]
L1, R1 = 4, 5
STAND_IN = """
  window.pads = [null, null, null, null];
  navigator.getGamepads = () => window.pads;
  window.plug = (index, more) => { window.pads[index] = {id: "stand-in", index, connected: true, mapping: "standard",
    axes: [0, 0, 0, 0], buttons: Array.from({length: 17}, () => ({pressed: false, value: 0})), ...more}; };
  window.press = (index, ...which) => window.pads[index].buttons.forEach((b, i) => { b.pressed = which.includes(i); });
"""


class Pad:
    """A page with stand-ins for gamepads, and the machine that it moves."""

    def __init__(self, page, machine):
        self.page, self.machine = page, machine

    def plug(self, index=0, **more):
        self.page.evaluate("([index, more]) => plug(index, more)", [index, more])

    def hold(self, *buttons, stick=0.0, index=0):
        """Buttons held, the left stick to the side."""
        self.page.evaluate(
            "([i, x, b]) => { press(i, ...b); pads[i].axes = [x, 0, 0, 0]; }", [index, stick, list(buttons)]
        )

    def says(self, words):
        self.page.wait_for_selector(f"#gamepad:has-text('{words}')")

    def moves(self, joint):
        """Wait until that joint alone moves."""
        before = self.machine.state().position
        while abs(self.machine.state().position[joint] - before[joint]) < np.radians(1.0):
            self.page.wait_for_timeout(20)
        others = np.delete(self.machine.state().position - before, joint)
        assert np.abs(others).max() == 0.0 and self.machine.state().valves_open

    def stands(self, seconds=HOLD):
        """After the time that a lost wish is held the arms stand, all the while."""
        self.page.wait_for_timeout(1e3 * (HOLD + 0.1))
        before, limit = self.machine.state().position, time.monotonic() + seconds
        while time.monotonic() < limit:
            assert not self.machine.state().valves_open
            self.page.wait_for_timeout(20)
        np.testing.assert_array_equal(self.machine.state().position, before)


@pytest.fixture(scope="module")
def served(one_browser, served_console):
    served = served_console(
        lambda: Machine(home_posture()), lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1))
    )
    yield served
    served.end()


@pytest.fixture
def pad(one_browser, served):
    page = one_browser.new_page()
    page.add_init_script(STAND_IN)
    page.goto(served.address)
    page.wait_for_selector("#hold:enabled")
    yield Pad(page, served.machine)
    page.close()


def test_a_gamepad_moves_the_arm_whose_button_is_held_and_no_other(pad):
    pad.plug()
    pad.says("hold L1")
    pad.hold(stick=1.0)
    pad.stands()  # no dead-man's button
    pad.hold(R1, stick=1.0)
    pad.moves(0)
    pad.hold(stick=1.0)
    pad.stands()
    pad.hold(L1, stick=-1.0)
    pad.moves(7)
    pad.hold(L1, R1, stick=-1.0)
    pad.stands()  # neither arm is meant
    pad.hold()
    pad.hold(L1, stick=0.1)
    pad.stands()  # play of a stick around its middle


@pytest.mark.parametrize(
    "lose",
    [
        "pads[0].connected = false",
        "pads[0] = null",
        "pads[0].axes = [NaN, 0, 0, 0]",
        "document.hasFocus = () => false",
        "window.dispatchEvent(new Event('blur'))",
        "Object.defineProperty(document, 'hidden', {value: true, configurable: true}),"
        " document.dispatchEvent(new Event('visibilitychange'))",
    ],
)
@pytest.mark.thorough
def test_a_lost_gamepad_or_window_stops_the_arms_until_all_is_let_go(pad, lose):
    pad.plug()
    pad.says("hold L1")
    pad.hold(R1, stick=1.0)
    pad.moves(0)
    pad.page.evaluate(lose)
    pad.stands()
    pad.page.evaluate(  # back again, and still held
        "delete document.hasFocus, delete document.hidden, plug(0, {axes: [1, 0, 0, 0]}), press(0, 5)"
    )
    pad.stands()
    pad.says("let go")
    pad.hold()
    pad.says("hold L1")
    pad.hold(R1, stick=1.0)
    pad.moves(0)


@pytest.mark.parametrize("stop", ["key", "button", "others"])
@pytest.mark.thorough
def test_after_a_stop_a_gamepad_that_is_still_held_moves_nothing(pad, stop):
    pad.plug()
    pad.says("hold L1")
    pad.hold(R1, stick=1.0)
    pad.moves(0)
    if stop == "key":
        pad.page.keyboard.press("Escape")
    elif stop == "button":
        pad.page.click("#stop")
    else:
        pad.machine.order(Order.STOP)
    pad.stands()
    pad.page.evaluate("socket.close()")  # permission to move goes off, and on again
    pad.page.wait_for_selector("#hold:disabled")
    pad.page.wait_for_selector("#hold:enabled")
    pad.stands()
    pad.hold()
    pad.says("hold L1")
    pad.hold(R1, stick=1.0)
    pad.moves(0)


@pytest.mark.thorough
def test_gamepads_of_another_kind_are_not_used_and_said(pad):
    for strange in ({"mapping": ""}, {"buttons": [{"pressed": False, "value": 0}] * 9}, {"axes": [0.0, 0.0]}):
        pad.plug(0, **strange)
        pad.says("not used")
        pad.page.evaluate("pads[0].buttons[5].pressed = true, pads[0].axes[0] = 1")
        pad.stands()
    pad.plug(2)  # beside one that is not used
    pad.says("hold L1")
    pad.hold(R1, stick=1.0, index=2)
    pad.moves(0)
    pad.plug(1)
    pad.says("hold L1")
    pad.hold(R1, stick=1.0, index=1)
    pad.stands()  # two that are held: nobody knows which one is meant
