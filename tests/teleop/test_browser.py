"""The page in a real browser: four clicks on the pictures, confirmation, stop, resume, done."""

import numpy as np
import pytest

from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

PATIENCE = 240_000  # ms; a busy computer plans slowly


@pytest.fixture
def address(browser, served_console):
    """A console on simple arms that run at twice real time."""
    served = served_console(
        lambda: Machine(home_posture(), realtime_rate=2.0),
        lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1)),
    )
    yield served.address
    served.end()


def test_four_clicks_in_a_browser_do_the_task(browser, address):
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(address)
    page.click("#snapshot")
    for picture, v, then in (
        ("edges", 150, "grasp it"),
        ("colour", 180, "cut it"),
        ("colour", 110, "confirm"),
    ):
        page.wait_for_selector(f"#{picture}.wants")
        box = page.locator(f"#{picture}").bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + v / 480 * box["height"])
        page.wait_for_function("text => document.querySelector('#say').innerText.includes(text)", arg=then)
    page.keyboard.press("Enter")
    page.wait_for_function(
        "() => document.querySelector('li.now') !== null", polling=50, timeout=PATIENCE
    )  # the list is written anew with each message; an element of it does not last
    page.keyboard.press("Escape")
    page.wait_for_selector("#resume:enabled")
    assert "valves closed" in page.inner_text("#valves")
    stop = page.locator("#stop").bounding_box()
    page.mouse.wheel(0, 2000)
    page.wait_for_timeout(200)
    assert page.locator("#stop").bounding_box() == stop  # always visible
    page.click("#resume")
    page.wait_for_function(
        "() => document.querySelector('#say').innerText.includes('Done after')", timeout=PATIENCE
    )
    assert page.locator("li.done").count() == 6 and not errors
