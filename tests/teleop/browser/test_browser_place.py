"""Pick and place in a real browser: task chosen, pipe, grasp and place clicked, refused on the pipe, carried, done."""

import numpy as np
import pytest
from four_clicks import click_picture, says
from loose_pipe_scene import GRASP, PIPE, PLACE, RAISED, TABLE, pixel

from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.place_plan import PLACE_STEPS
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect


@pytest.fixture
def served(browser, served_console):
    """A console on simple arms at six times real time, with a loose pipe."""
    served = served_console(
        lambda: Machine(home_posture(), realtime_rate=6.0, pipe=PIPE, table=TABLE),
        lambda: SimulatedKinect(PIPE, np.random.default_rng(1), table=TABLE),
    )
    yield served
    served.end()


@pytest.mark.thorough
def test_pick_and_place_in_a_browser(browser, served):
    page = browser.new_page()
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(served.address)

    def click(point):
        click_picture(page, "colour", *pixel(np.array(point)))

    page.click("[name=task][value=place]")
    page.wait_for_function(
        "count => document.querySelectorAll('#steps li').length === count", arg=len(PLACE_STEPS)
    )
    page.click("#snapshot")
    says(page, "Click the pipe")
    click(RAISED)
    says(page, "grasp it")
    click(GRASP)
    says(page, "put it down")
    click(PIPE.point)
    says(page, "on the pipe itself")
    click(PLACE)
    says(page, "confirm")
    page.keyboard.press("Enter")
    says(page, "Done after")
    assert page.locator("li.done").count() == len(PLACE_STEPS) and not errors
    np.testing.assert_allclose(served.machine.state().pipe.point[:2], PLACE[:2], atol=0.03)
