"""Pick and place in a real browser: task chosen, pipe, grasp and place clicked, refused on the pipe, carried, done."""

import numpy as np
import pytest

from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.place_plan import PLACE_STEPS
from hydrolek_drake.vision.camera import camera_pose, thesis_camera
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect
from hydrolek_drake.workcell.table import make_loose_pipe, make_table

TABLE = make_table()
PIPE = make_loose_pipe(TABLE)
RAISED, GRASP = (PIPE.point + np.array([0, 0, up]) for up in (0.1, 0.2))
PLACE = np.array([1.85, 0.20, TABLE.top[2]])


def _pixel(point):
    pose = camera_pose()
    on_plate = in_frame(point, given_in="world", wanted_in="plate")
    return thesis_camera().pixel((on_plate - pose[:3, 3]) @ pose[:3, :3])


@pytest.fixture
def served(browser, served_console):
    """A console on simple arms at six times real time, with a loose pipe."""
    served = served_console(
        lambda: Machine(home_posture(), realtime_rate=6.0, pipe=PIPE, table=TABLE),
        lambda: SimulatedKinect(PIPE, np.random.default_rng(1), table=TABLE),
    )
    yield served
    served.end()


def test_pick_and_place_in_a_browser(browser, served):
    page = browser.new_page()
    errors = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(served.address)

    def says(text, **named):
        page.wait_for_function(
            "text => document.querySelector('#say').innerText.includes(text)", arg=text, **named
        )

    def click(point):
        page.wait_for_selector("#colour.wants")
        box, (u, v) = page.locator("#colour").bounding_box(), _pixel(np.array(point))
        page.mouse.click(
            box["x"] + (u + 0.5) / 640 * box["width"], box["y"] + (v + 0.5) / 480 * box["height"]
        )

    page.click("[name=task][value=place]")
    page.wait_for_function(
        "count => document.querySelectorAll('#steps li').length === count", arg=len(PLACE_STEPS)
    )
    page.click("#snapshot")
    says("Click the pipe")
    click(RAISED)
    says("grasp it")
    click(GRASP)
    says("put it down")
    click(PIPE.point)
    says("on the pipe itself")
    click(PLACE)
    says("confirm")
    page.keyboard.press("Enter")
    says("Done after")
    assert page.locator("li.done").count() == len(PLACE_STEPS) and not errors
    np.testing.assert_allclose(served.machine.state().pipe.point[:2], PLACE[:2], atol=0.03)
