"""The whole job in a real browser on the hydraulic plant: clicks, grasp, cut, charts, joystick, a saved trial.

With HYDROLEK_PICTURES set to a folder, the pictures of docs/guides/teleop.md are written there.
"""

import csv
import os
import time
from pathlib import Path

import numpy as np
import pytest
from four_clicks import click_the_pipe, says

from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.plant_process import PlantProcess
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Mode
from hydrolek_drake.teleop.trial import TrialLog
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect

# one plant for all, which takes a while
pytestmark = [pytest.mark.xdist_group("console on the hydraulic plant"), pytest.mark.thorough]

PICTURES = os.environ.get("HYDROLEK_PICTURES")
REQUIRED = 5e-3  # m, at the grasp
PACE = 1.0  # simulated seconds a second; where the computer is too slow, plant and task wait for each other
PATIENCE = 240.0  # s; on a busy computer the plant falls behind the clock and the task waits for it


@pytest.fixture(scope="module")
def plants(served_console, tmp_path_factory):
    """Makes the console on the hydraulic plant, with Drake's view, when it is first asked for."""
    made = []

    def make():
        if not made:
            pipe, folder = make_pipe(), tmp_path_factory.mktemp("trials", numbered=False)
            plant = PlantProcess(home_posture(), meshcat=True, pipe=pipe, realtime_rate=PACE)
            served = served_console(
                lambda: Machine(home_posture(), plant=plant, realtime_rate=PACE),
                lambda: SimulatedKinect(pipe, np.random.default_rng(1)),
                view_port=plant.view_port,
                trials=TrialLog(folder),
            )
            served.folder, served.view = folder, f"http://127.0.0.1:{plant.view_port}/"
            made.append(served)
        return made[0]

    yield make
    for served in made:
        served.end()


@pytest.fixture
def served(browser, plants):  # a test that is skipped for want of a browser makes no plant
    return plants()


@pytest.fixture
def page(browser, served, request):
    page = browser.new_page()
    with_view = getattr(request, "param", False)
    if not with_view:  # drawing it without a graphics card holds up the plant
        page.route(f"{served.view}**", lambda route: route.abort())
    page.failures = []
    page.on("pageerror", lambda error: page.failures.append(str(error)))
    page.goto(served.address)
    if not with_view:
        page.add_style_tag(content="#view { display: none }")
    page.wait_for_selector("#snapshot:enabled")
    yield page
    assert not page.failures


def _keep(page, name, selector=None):
    if PICTURES:
        target = page if selector is None else page.locator(selector)
        target.screenshot(path=Path(PICTURES) / f"{name}.png")


def _step(page, name):
    page.wait_for_function(
        "name => [...document.querySelectorAll('li.now')].some(li => li.innerText === name)", arg=name
    )


def _ink(page, canvas):
    """How many pixels of a canvas have something on them."""
    return page.evaluate(
        """i => {
            const c = document.querySelectorAll('#charts canvas')[i];
            const pixels = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
            return pixels.filter((v, k) => k % 4 === 3 && v).length;
        }""",
        canvas,
    )


def _tool(angles, side):
    pose = tool_pose(angles)
    return in_frame(pose[:3, 3], given_in=f"{side}_base", wanted_in="world"), pose


def _until(true, seconds=PATIENCE):
    """Wait until what `true` returns is so; the clock alone says nothing on a busy computer."""
    limit = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < limit, f"not within {seconds:g} s"
        time.sleep(0.05)


def _moved(served, joint, start):
    return np.degrees(served.states[-1].position[joint] - start[joint])


def _simulate(served, seconds):
    """Let the plant's own time go on, and the state that is read with it."""
    end = served.states[-1].signals.time + seconds
    _until(lambda: served.states[-1].signals.time > end)


def _valves_are_closed(state):
    return state.manual == "" and not state.valves_open and not state.signals.voltage.any()


def test_a_browser_that_is_closed_stops_the_joystick(served, page):
    start = served.states[-1].position
    page.locator("#hand button[aria-label='right 1 up']").focus()
    page.keyboard.down("Space")
    _until(lambda: served.states[-1].manual == "joystick" and _moved(served, 0, start) > 1.0)
    page.close()
    _until(lambda: _valves_are_closed(served.states[-1]))


def test_joystick_sliders_and_a_saved_trial_in_the_browser(served, page):
    _simulate(served, 1.0)  # at rest
    page.click("#timer_start")
    start = served.states[-1].position
    up = page.locator("#hand button[aria-label='right 2 up']")
    up.hover()
    page.mouse.down()
    _until(lambda: _moved(served, 1, start) > 3.0)
    assert page.inner_text("#by_hand") == "joystick"
    _keep(page, "console_hand", "section:has(#hand)")
    page.mouse.up()
    page.wait_for_selector("#by_hand:has-text('let go')")
    _simulate(served, 0.6)
    still = served.states[-1].position
    assert np.abs(np.delete(np.degrees(still - start), 1)).max() < 1.0
    _simulate(served, 0.5)
    np.testing.assert_allclose(served.states[-1].position, still, atol=np.radians(1.0))

    # by keyboard, stopped by Escape although Space is still held
    page.locator("#hand button[aria-label='left 1 down']").focus()
    page.keyboard.down("Space")
    _until(lambda: _moved(served, 7, start) < -2.0)
    page.keyboard.press("Escape")
    _until(lambda: _valves_are_closed(served.states[-1]))
    _simulate(served, 0.6)
    assert _valves_are_closed(served.states[-1])
    page.keyboard.up("Space")

    # the sliders bring the joints back that were moved
    home, tolerance = home_posture(), np.radians(teleop_entries("task")["tolerance_deg"])
    moved = {"right 1": 0, "right 2": 1, "left 1": 7}
    assert np.abs(served.states[-1].position - home)[[1, 7]].min() > tolerance
    for name, joint in moved.items():
        slider = page.locator(f"input[aria-label='{name}, wanted angle in degrees']")
        slider.fill(str(round(np.degrees(home[joint]))))
    page.locator("#hold").focus()
    page.keyboard.down("Space")
    _until(lambda: np.abs(served.states[-1].position - home)[list(moved.values())].max() < tolerance)
    page.keyboard.up("Space")
    _until(lambda: _valves_are_closed(served.states[-1]))

    page.click("#timer_stop")
    page.fill("#operator", "test")
    page.select_option("#control", "joystick")
    page.locator("#ratings input").first.fill("80")
    page.click("#save")
    page.wait_for_selector("#saved:has-text('1 saved')")
    _keep(page, "console_trial", "section:has(#ratings)")
    with open(served.folder / "trials.csv", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["operator"] == "test" and float(row["raw_tlx"]) == pytest.approx((80 + 5 * 50) / 6, abs=0.01)
    assert float(row["task_s"]) > 2.0


@pytest.mark.parametrize("page", [True], indirect=True)
def test_drake_s_view_stands_beside_the_pictures(served, page):
    page.wait_for_selector("#view iframe")
    frame = page.frame(url=lambda url: url.startswith(served.view))
    frame.wait_for_function(
        "() => typeof viewer !== 'undefined' && viewer.scene_tree.find(['pipe']) !== undefined"
    )
    box = page.locator("#view").bounding_box()
    assert box["width"] > 400 and box["height"] > 300
    if PICTURES:  # each takes many seconds without a graphics card
        page.locator("#view").scroll_into_view_if_needed()
        page.wait_for_timeout(4000)
        _keep(page, "console_view", "#side")


@pytest.mark.long("takes over a minute; the same task without a browser: test_hydraulic_machine.py")
def test_the_task_on_the_hydraulic_plant_from_the_browser(served, page):
    pipe, begin = make_pipe(), len(served.states)
    click_the_pipe(page)
    _keep(page, "console_confirm")
    page.keyboard.press("Enter")
    _step(page, "grasp")
    _step(page, "cut")
    page.wait_for_timeout(400)
    _keep(page, "console_moving")
    says(page, "Done after")
    assert page.locator("li.done").count() == 6
    page.wait_for_timeout(300)
    _keep(page, "console_charts", "section:has(#charts)")
    # from the first step on; before it, a link that was lost on a busy computer may have been found again
    states = [state for state in served.states[begin:] if state.mode in (Mode.RUNNING, Mode.DONE)]

    # the grasp: where the tool stood when the gripper was told to close, and that the gripper closed
    settled = round(teleop_entries("task")["settled"] / teleop_entries("task")["period"])
    readings = [state.position for state in states if state.step == "grasp"][-settled:]
    before = np.mean(readings, axis=0)  # the joints have settled; the mean takes the sensors' noise out
    tool, _ = _tool(before[:6], "right")
    offset = tool - pipe.point
    assert np.linalg.norm(offset - (offset @ pipe.axis) * pipe.axis) < REQUIRED
    assert np.degrees(before[6]) > 35.0
    assert 10.0 < np.degrees(states[-1].position[6]) < 30.0  # told to close to 0, it closed on the pipe
    assert states[-1].signals.grip[0] > 1e3 and states[-1].signals.grip[1] == 0.0
    assert "right" in page.inner_text("#grip")

    # the cut: the blade's cutting point went across the whole pipe
    blade = kinect_entries("targets")["blade_reach"]
    points = []
    for state in states:
        if state.step == "cut":
            tool, pose = _tool(state.position[7:13], "left")
            tip = pose[:3, 3] + blade * pose[:3, 0]
            points.append(in_frame(tip, given_in="left_base", wanted_in="world") - pipe.point)
    points = np.array(points)
    across = points[:, 1]  # the pipe stands before the camera: the cut goes along y
    assert across.min() < -pipe.radius and across.max() > pipe.radius
    padding = workcell_entries()["motion"]["padding"]  # what is kept clear for control that is off
    assert np.ptp(points[np.abs(across) < pipe.radius][:, 2]) < 2 * padding

    # the machine was hydraulic, and the page shows it
    voltage = np.array([state.signals.voltage for state in states])
    assert (np.abs(voltage[:, :5]).max(axis=0) > 1.0).all()
    for canvas in range(6):
        assert _ink(page, canvas) > 1000
    pots = page.locator("#angles tr:first-child td:nth-child(4)").inner_text()
    assert float(pots) == pytest.approx(states[-1].signals.potentiometer[0], abs=0.2)
