"""One planned task for all tests, from a rendered frame as the console plans it; a console in a thread; a browser."""

import asyncio
import contextlib
import os
import shutil
import threading

import numpy as np
import pytest

from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop import camera_thread
from hydrolek_drake.teleop.access import page_address
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.console.server import Console
from hydrolek_drake.teleop.plan import plan_task
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.vision.camera import camera_pose
from hydrolek_drake.vision.edges import default_settings
from hydrolek_drake.vision.selection import select_object
from hydrolek_drake.vision.snapshot import take_snapshot
from hydrolek_drake.vision.targets import pipe_targets, pixel_targets
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands

_PATIENCE = 240e3  # ms; on a busy computer everything takes long, and what comes late is not wrong


def pixel_of(point, camera):
    pose = camera_pose()
    on_plate = in_frame(point, given_in="world", wanted_in="plate")
    return camera.pixel((on_plate - pose[:3, 3]) @ pose[:3, :3])


def plan_for(pipe, grasp, cut, grasping="right"):
    frame = SimulatedKinect(pipe, np.random.default_rng(1)).read()
    snapshot = take_snapshot(frame.colour, frame.depth, frame.camera, default_settings())
    clicks = [pixel_of(pipe.point + along * pipe.axis, frame.camera) for along in (grasp, cut)]
    selected = select_object(snapshot, tuple(clicks[0])).mask
    pixels = pixel_targets(snapshot, selected, *clicks, frame.camera)
    targets = pipe_targets(snapshot, selected, pixels, frame.camera)
    return plan_task(targets, frame.camera, home_posture(), np.random.default_rng(1), grasping=grasping)


@pytest.fixture(autouse=True)
def patient_camera(monkeypatch):
    """A camera that is rendered by a busy computer is slow and not lost."""
    monkeypatch.setattr(
        camera_thread, "teleop_entries", lambda part: {**teleop_entries(part), "mute": 1e-3 * _PATIENCE}
    )


@pytest.fixture(scope="session")
def plan():
    return plan_for(make_pipe(), -0.05, 0.12)


@pytest.fixture(scope="session")
def planner():
    return plan_for


@pytest.fixture
def browser():
    """Debian's Chromium, or Chrome, driven by Playwright; a test that asks for it is skipped where one is absent."""
    with _chromium() as context:
        yield context


@pytest.fixture(scope="module")
def one_browser():
    """The same for all tests of a file."""
    with _chromium() as context:
        yield context


@contextlib.contextmanager
def _chromium():
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="Playwright drives the browser and is absent: pip install playwright"
    )
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None:
        pytest.skip("there is no chromium, chromium-browser or google-chrome on the search path")
    options = ["--enable-unsafe-swiftshader"]  # Drake's view without a graphics card
    if os.geteuid() == 0:
        options.append("--no-sandbox")  # Chromium refuses its sandbox to root
    with playwright.sync_playwright() as engine:
        chromium = engine.chromium.launch(executable_path=found, args=options)
        context = chromium.new_context(viewport={"width": 1280, "height": 940})
        context.set_default_timeout(_PATIENCE)
        yield context
        chromium.close()


class ServedConsole:
    """A console in a thread of its own, until `end`.

    Attributes:
        address: Of its page.
        machine: That it moves.
        states: Of the machine, one each 50 ms.
    """

    def __init__(self, make_machine, source, **named):
        self.states, self._ended = [], threading.Event()
        self._ready, self._failure = threading.Event(), None
        self._thread = threading.Thread(
            target=lambda: asyncio.run(self._serve(make_machine, source, named)), daemon=True
        )
        self._thread.start()
        self._ready.wait()
        if self._failure is not None:
            raise self._failure

    async def _serve(self, make_machine, source, named):
        try:
            self.machine = make_machine()
            session = OperatorSession(source, self.machine, seed=1, stand=as_machine_stands)
            console = Console(session, port=0, **named)
            self.address = page_address("127.0.0.1", console.port, console.token)
        except BaseException as error:
            self._failure = error
            return
        finally:
            self._ready.set()
        running = asyncio.ensure_future(console.run())
        while not self._ended.is_set():
            self.states.append(self.machine.state())
            await asyncio.sleep(0.05)
        running.cancel()
        console.close()
        self.machine.close()
        session.close()

    def end(self):
        self._ended.set()
        self._thread.join(1e-3 * _PATIENCE)
        assert not self._thread.is_alive()


@pytest.fixture(scope="session")
def served_console():
    return ServedConsole
