"""The page in a real browser: four clicks, confirmation, stop, resume, done; bad clicks; two browsers."""

import os

import numpy as np
import pytest
from casting import cast_crossing
from four_clicks import click_picture, click_the_pipe, says

from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect


@pytest.fixture
def served(browser, served_console):
    """A console on simple arms that run at twice real time."""
    served = served_console(
        lambda: Machine(home_posture(), realtime_rate=2.0),
        lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1)),
    )
    yield served
    served.end()


@pytest.mark.thorough
def test_four_clicks_in_a_browser_do_the_task(browser, served):
    page = browser.new_page()
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(served.address)
    click_the_pipe(page)
    page.keyboard.press("Enter")
    page.wait_for_function(
        "() => document.querySelector('li.now') !== null", polling=50
    )  # the list is written anew with each message; an element of it does not last
    page.keyboard.press("Escape")
    page.wait_for_selector("#resume:enabled")
    assert "valves closed" in page.inner_text("#valves")
    stop = page.locator("#stop").bounding_box()
    page.mouse.wheel(0, 2000)
    page.wait_for_timeout(200)
    assert page.locator("#stop").bounding_box() == stop  # always visible
    page.click("#resume")
    page.wait_for_function("() => document.querySelector('#say').innerText.includes('Done after')")
    assert page.locator("li.done").count() == 6 and not errors


@pytest.mark.thorough
def test_while_the_arms_move_task_time_left_and_charts_are_on_one_screen(browser, served):
    page = browser.new_page()
    page.set_viewport_size({"width": 1372, "height": 882})
    page.goto(served.address)
    click_the_pipe(page)
    page.keyboard.press("Enter")
    page.wait_for_function(
        "() => /about .* left/.test(document.querySelector('#whole').innerText)", timeout=60_000
    )
    page.evaluate("window.scrollTo(0, 0)")
    if "HYDROLEK_PICTURES" in os.environ:
        page.wait_for_timeout(4000)
        page.screenshot(path=os.path.join(os.environ["HYDROLEK_PICTURES"], "console_time_left.png"))
    for name in ("#tasks", "#camera .picture", "#last"):
        box = page.locator(name).bounding_box()
        assert box["y"] >= 0.0 and box["y"] + box["height"] <= 882.0, name
    assert not page.locator("#edge_sliders").is_visible()
    before = int(page.get_attribute("#whole", "aria-valuenow"))
    page.wait_for_function(
        "before => Number(document.querySelector('#whole').getAttribute('aria-valuenow')) > before",
        arg=before,
    )
    says(page, "Done after", timeout=120_000)
    assert not page.locator("#whole").is_visible() and page.locator("#edge_sliders").is_visible()
    page.close()


def test_bad_clicks_are_told_in_the_browser_and_a_second_one_watches(browser, served):
    page = browser.new_page()
    page.goto(served.address)
    page.click("#snapshot")
    click_picture(page, "colour", 500, 50)
    page.wait_for_selector("#note.bad:has-text('nothing within reach')")
    page.evaluate("send({do: 'click', u: -10, v: 10})")  # the page itself sends no such click
    page.wait_for_selector("#note.bad:has-text('outside the picture')")
    assert "Click the pipe" in page.inner_text("#instruction")

    second = browser.new_page()
    second.goto(served.address)
    second.wait_for_selector("#instruction:has-text('Watching')")
    assert second.locator("#snapshot").is_disabled() and second.locator("#stop").is_enabled()
    second.evaluate("send({do: 'click', u: 320, v: 150})")
    second.wait_for_selector("#note.bad:has-text('in control')")
    page.close()
    second.wait_for_selector("#snapshot:enabled")
    second.close()
    assert {state.mode for state in served.states} == {Mode.IDLE}
    assert not any(state.valves_open for state in served.states)


@pytest.mark.thorough
def test_before_the_console_answers_only_stop_can_be_pressed_and_it_is_not_forgotten(browser, served):
    page = browser.new_page()
    heard = []

    def hear(socket):  # and never answer
        socket.on_message(lambda message: heard.append(message))

    page.route_web_socket("**/socket", hear)
    page.goto(served.address)
    page.wait_for_function("() => socket.readyState === 1")
    enabled = [
        button.get_attribute("id") for button in page.query_selector_all("header button, .row button:enabled")
    ]
    assert enabled == ["stop"]
    told_at_once = ["[name=task]", "[name=fill]", "#low_contrast", "#high_contrast", "#sensitivity"]
    for what in told_at_once:  # a choice made now would be lost
        assert page.query_selector(what) and not page.query_selector(f"{what}:enabled")
    page.evaluate("socket.close()")
    page.wait_for_selector("#note.bad:has-text('Connection lost')")
    page.click("#stop")
    while not any('"stop"' in message for message in heard):
        page.wait_for_timeout(50)


@pytest.mark.thorough
def test_an_unsure_object_is_told_in_the_browser_and_a_second_click_shows_the_other(browser, served_console):
    colour, depth, _, _ = cast_crossing(0.01)

    class Crossing(FrameSource):
        def read(self):
            return Frame(colour, depth, recorded_camera(), "cast")

    served = served_console(lambda: Machine(home_posture()), Crossing)
    try:
        page = browser.new_page()
        page.goto(served.address)
        page.click("#snapshot")
        click_picture(page, "colour", 100, 240)
        page.wait_for_selector("#note.unsure:has-text('Unsure of this outline')")
        shown = page.get_attribute("#edges img", "src")
        click_picture(page, "edges", 100, 240)
        page.wait_for_function(
            "shown => document.querySelector('#edges img').src !== shown", arg=shown, polling=50
        )
        assert "grasp it" in page.inner_text("#instruction")
        click_picture(page, "colour", 160, 240)
        says(page, "cut it")
        page.wait_for_function("() => document.querySelector('#note.unsure') === null")
    finally:
        served.end()
