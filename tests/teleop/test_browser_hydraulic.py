"""The whole job in a real browser on the hydraulic plant: clicks, grasp, cut, charts, joystick, a saved trial.

With HYDROLEK_PICTURES set to a folder, the pictures of docs/teleop.md are written there.
"""

import asyncio
import csv
import os
import shutil
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.console import Console
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.plant_process import PlantProcess
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.teleop.trial import TrialLog
from hydrolek_drake.vision.configuration import kinect_entries
from hydrolek_drake.workcell.pipe import make_pipe, workcell_entries
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright to drive a browser")
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="needs Chromium or Chrome on the search path")

PICTURES = os.environ.get("HYDROLEK_PICTURES")
REQUIRED = 5e-3  # m, at the grasp
PATIENCE = 240.0  # s; on a busy computer the plant falls behind the clock and the task waits for it


class Served:
    """A console on the hydraulic plant in a thread, and what its machine did."""

    def __init__(self, folder, *, meshcat):
        self.ready, self.ended, self.states, self.folder = threading.Event(), threading.Event(), [], folder
        self.meshcat = meshcat
        self.thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)
        self.thread.start()
        assert self.ready.wait(90.0)

    async def _serve(self):
        pipe = make_pipe()
        plant = PlantProcess(home_posture(), meshcat=self.meshcat, pipe=pipe)
        machine = Machine(home_posture(), plant=plant)
        session = OperatorSession(
            lambda: SimulatedKinect(pipe, np.random.default_rng(1)),
            machine,
            seed=1,
            stand=as_machine_stands,
        )
        console = Console(session, port=0, view_port=plant.view_port, trials=TrialLog(self.folder))
        running = asyncio.ensure_future(console.run())
        self.address = f"http://127.0.0.1:{console.port}/"
        self.ready.set()
        while not self.ended.is_set():
            self.states.append(machine.state())
            await asyncio.sleep(0.05)
        running.cancel()
        console.close()
        machine.close()
        session.close()

    def end(self):
        self.ended.set()
        self.thread.join(20.0)
        assert not self.thread.is_alive()


@pytest.fixture
def served(tmp_path, request):
    served = Served(tmp_path, meshcat=getattr(request, "param", False))
    yield served
    served.end()


@pytest.fixture
def page(served):
    with playwright.sync_playwright() as engine:
        browser = engine.chromium.launch(
            executable_path=BROWSER, args=["--no-sandbox", "--enable-unsafe-swiftshader"]
        )
        page = browser.new_page(viewport={"width": 1280, "height": 940})
        page.failures = []
        page.on("pageerror", lambda error: page.failures.append(str(error)))
        page.goto(served.address)
        page.wait_for_selector("#snapshot:enabled")
        yield page
        assert not page.failures
        browser.close()


def _keep(page, name, selector=None):
    if PICTURES:
        target = page if selector is None else page.locator(selector)
        target.screenshot(path=Path(PICTURES) / f"{name}.png")


def _says(page, text, seconds=30.0):
    page.wait_for_function(
        "text => document.querySelector('#say').innerText.includes(text)", arg=text, timeout=1e3 * seconds
    )


def _step(page, name, seconds=30.0):
    page.wait_for_function(
        "name => [...document.querySelectorAll('li.now')].some(li => li.innerText === name)",
        arg=name,
        timeout=1e3 * seconds,
    )


def _click_the_pipe(page):
    page.click("#snapshot")
    for picture, v, then in (
        ("edges", 150, "grasp it"),
        ("colour", 180, "cut it"),
        ("colour", 110, "confirm"),
    ):
        page.wait_for_selector(f"#{picture}.wants")
        box = page.locator(f"#{picture}").bounding_box()
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + v / 480 * box["height"])
        _says(page, then)


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


def test_the_task_on_the_hydraulic_plant_from_the_browser(served, page):
    pipe = make_pipe()
    _click_the_pipe(page)
    _keep(page, "console_confirm")
    page.keyboard.press("Enter")
    _step(page, "grasp", PATIENCE)
    _step(page, "cut", PATIENCE)
    page.wait_for_timeout(400)
    _keep(page, "console_moving")
    _says(page, "Done after", PATIENCE)
    assert page.locator("li.done").count() == 6
    page.wait_for_timeout(300)
    _keep(page, "console_charts", "section:has(#charts)")
    states = served.states

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


def test_joystick_sliders_and_a_saved_trial_in_the_browser(served, page):
    page.click("#timer_start")
    start = served.states[-1].position
    up = page.locator("#hand button[aria-label='right 2 up']")
    up.scroll_into_view_if_needed()
    box = up.bounding_box()
    page.mouse.move(box["x"] + 5, box["y"] + 5)
    page.mouse.down()
    page.wait_for_timeout(1200)
    assert page.inner_text("#by_hand") == "joystick"
    _keep(page, "console_hand", "section:has(#hand)")
    page.mouse.up()
    page.wait_for_selector("#by_hand:has-text('let go')")
    page.wait_for_timeout(600)
    moved = np.degrees(served.states[-1].position - start)
    assert moved[1] > 3.0 and np.abs(np.delete(moved, 1)).max() < 1.0
    still = served.states[-1].position
    page.wait_for_timeout(500)
    np.testing.assert_allclose(served.states[-1].position, still, atol=np.radians(1.0))

    # by keyboard, stopped by Escape although Space is still held
    page.locator("#hand button[aria-label='left 1 down']").focus()
    page.keyboard.down("Space")
    page.wait_for_timeout(700)
    page.keyboard.press("Escape")
    page.wait_for_timeout(600)
    stopped = served.states[-1]
    assert np.degrees(start[7] - stopped.position[7]) > 2.0
    assert not stopped.valves_open
    np.testing.assert_array_equal(stopped.signals.voltage, 0.0)
    page.keyboard.up("Space")

    slider = page.locator("input[aria-label='right 3, wanted angle in degrees']")
    slider.fill("-10")
    page.locator("#hold").focus()
    page.keyboard.down("Space")
    page.wait_for_timeout(2500)
    page.keyboard.up("Space")
    page.wait_for_timeout(500)
    assert np.degrees(served.states[-1].position[2]) == pytest.approx(-10.0, abs=1.0)

    page.click("#timer_stop")
    page.fill("#operator", "test")
    page.select_option("#control", "joystick")
    page.locator("#ratings input").first.fill("80")
    _keep(page, "console_trial", "section:has(#ratings)")
    page.click("#save")
    page.wait_for_selector("#saved:has-text('1 saved')")
    with open(served.folder / "trials.csv", newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["operator"] == "test" and float(row["raw_tlx"]) == pytest.approx((80 + 5 * 50) / 6, abs=0.01)
    assert float(row["task_s"]) > 4.0


def test_a_browser_that_is_closed_stops_the_joystick(served, page):
    up = page.locator("#hand button[aria-label='right 1 up']")
    up.focus()
    page.keyboard.down("Space")
    page.wait_for_timeout(1000)
    assert served.states[-1].manual == "joystick"
    page.close()
    time.sleep(0.8)
    state = served.states[-1]
    assert state.manual == "" and not state.valves_open
    np.testing.assert_array_equal(state.signals.voltage, 0.0)


@pytest.mark.parametrize("served", [True], indirect=True)
def test_drake_s_view_stands_beside_the_pictures(served, page):
    page.wait_for_selector("#view iframe")
    frame = page.frame(url=lambda url: url != served.address and url.startswith("http://127.0.0.1"))
    frame.wait_for_function(
        "() => typeof viewer !== 'undefined' && viewer.scene_tree.find(['pipe']) !== undefined"
    )
    box = page.locator("#view").bounding_box()
    assert box["width"] > 400 and box["height"] > 300
    page.locator("#view").scroll_into_view_if_needed()
    page.wait_for_timeout(4000 if PICTURES else 200)
    _keep(page, "console_view", "#side")
