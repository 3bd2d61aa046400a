"""The page in a real browser: four clicks on the pictures, confirmation, stop, resume, done."""

import asyncio
import shutil
import threading

import numpy as np
import pytest

from hydrolek_drake.teleop.console import Console
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands

playwright = pytest.importorskip("playwright.sync_api", reason="needs Playwright to drive a browser")
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason="needs Chromium or Chrome on the search path")


@pytest.fixture
def address():
    """A console in a thread, on a machine that runs six times real time."""
    ready, stop, found = threading.Event(), threading.Event(), []

    async def serve():
        machine = Machine(home_posture(), realtime_rate=6.0)
        session = OperatorSession(
            lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1)),
            machine,
            seed=1,
            stand=as_machine_stands,
        )
        console = Console(session, port=0)
        running = asyncio.ensure_future(console.run())
        found.append(f"http://127.0.0.1:{console.port}/")
        ready.set()
        while not stop.is_set():
            await asyncio.sleep(0.05)
        running.cancel()
        console.close()
        machine.close()
        session.close()

    thread = threading.Thread(target=lambda: asyncio.run(serve()), daemon=True)
    thread.start()
    assert ready.wait(20.0)
    yield found[0]
    stop.set()
    thread.join(20.0)


def test_four_clicks_in_a_browser_do_the_task(address):
    with playwright.sync_playwright() as engine:
        browser = engine.chromium.launch(executable_path=BROWSER, args=["--no-sandbox"])
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
            page.wait_for_function(
                "text => document.querySelector('#say').innerText.includes(text)", arg=then
            )
        page.keyboard.press("Enter")
        page.wait_for_selector("li.now")
        page.keyboard.press("Escape")
        page.wait_for_selector("#resume:enabled")
        assert "valves closed" in page.inner_text("#valves")
        stop = page.locator("#stop").bounding_box()
        page.mouse.wheel(0, 2000)
        page.wait_for_timeout(200)
        assert page.locator("#stop").bounding_box() == stop  # always visible
        page.click("#resume")
        page.wait_for_function(
            "() => document.querySelector('#say').innerText.includes('Done after')", timeout=60_000
        )
        assert page.locator("li.done").count() == 6 and not errors
        browser.close()
