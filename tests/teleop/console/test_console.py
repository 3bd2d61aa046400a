"""The console over HTTP and the web socket: two browsers, malformed and oversized messages, the whole task."""

import asyncio
import urllib.request

import numpy as np
import pytest
from console_client import Black, ask, connect, next_state, served

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.console.server import Console
from hydrolek_drake.teleop.trial import SCALES, TrialLog
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands


def _served(work, source=None, rate=25.0):
    """Run `work(console)` against a console with a fast machine, and the simulated camera if no other is given."""

    def simulated():
        return SimulatedKinect(make_pipe(), np.random.default_rng(1))

    stand = as_machine_stands if source is None else None
    served(lambda console, machine: work(console), source or simulated, rate=rate, stand=stand)


async def _click_the_pipe(socket):
    assert await ask(socket, {"do": "snapshot"}) == ""
    for v in (150, 180, 110):
        assert await ask(socket, {"do": "click", "u": 319.5, "v": v}) == ""


async def _stands_still(socket):
    state = (await next_state(socket))["state"]
    assert state["mode"] == "idle" and not state["valves_open"]
    np.testing.assert_allclose(np.radians(state["angles_deg"]), home_posture(), atol=1e-3)


def test_the_page_and_the_whole_task():
    async def work(console):
        loop = asyncio.get_running_loop()
        address = f"http://127.0.0.1:{console.port}/"
        page = await loop.run_in_executor(None, lambda: urllib.request.urlopen(address).read().decode())
        assert 'id="stop"' in page and "/socket" in page
        socket = await connect(console)
        await _click_the_pipe(socket)
        picture = await loop.run_in_executor(
            None, lambda: urllib.request.urlopen(address + "edges.jpg").read()
        )
        assert picture[:2] == b"\xff\xd8"  # JPEG
        seen = set()
        assert await ask(socket, {"do": "confirm"}, seen) == ""
        while True:
            state = (await next_state(socket))["state"]
            seen.add(state["step"])
            if state["stage"] == "live":
                break
        assert state["mode"] == "done" and {"approach", "cut"} <= seen

    _served(work, rate=4.0)  # slow enough for the states, ten a second, to show every step


def test_of_two_browsers_the_second_watches_and_may_stop():
    async def work(console):
        first, second = await connect(console), await connect(console)
        assert (await next_state(first))["in_control"] and not (await next_state(second))["in_control"]
        assert "in control" in await ask(second, {"do": "snapshot"})
        assert await ask(second, {"do": "stop"}) == ""
        first.close()
        while not (await next_state(second))["in_control"]:
            pass
        assert await ask(second, {"do": "snapshot"}) == ""

    _served(work)


@pytest.mark.parametrize(
    ("message", "answer"),
    [
        ("not json", "must be JSON"),
        ("[" * 3000, "must be JSON"),
        ("[1, 2]", "an object"),
        ({"do": "explode"}, "does not know 'explode'"),
        ({"do": {}}, "does not know '{}'"),
        ({"do": ["a"]}, "does not know"),
        ({"do": None}, "does not know 'None'"),
        ({}, "an object with 'do'"),
        ('{"do": "click", "u": ' + "9" * 350 + ', "v": 1}', "finite number"),
        ('{"do": "click", "u": 1, "v": ' + "9" * 4000 + "}", "finite number"),
        ({"do": "click", "u": 1}, "'v' is missing"),
        ({"do": "click", "u": 1, "v": 1, "w": 1}, "'w' is unknown"),
        ('{"do": "stop", "x": {"a": [[[[1]]]]}}', "'x' is unknown"),
        ({"do": "token", "token": 5}, "must be text"),
        ({"do": "token", "token": "x" * 300}, "at most 200"),
        ({"do": "ratings", "mental": "9" * 350}, "finite number"),
        ({"do": "click", "u": "a", "v": 3}, "finite number"),
        ({"do": "click", "u": True, "v": 3}, "finite number"),
        ('{"do": "click", "u": NaN, "v": 1}', "finite number"),
        ({"do": "sliders", "sensitivity": 9}, "between 0 and 1"),
        ({"do": "fill", "name": "x"}, "choose from"),
        ({"do": "confirm"}, "must be clicked"),
        ({"do": "joystick"}, "'deflection' is missing"),
        ({"do": "joystick", "deflection": [0] * 13}, "14 numbers"),
        ({"do": "joystick", "deflection": [0] * 13 + ["x"]}, "finite number"),
        ({"do": "joystick", "deflection": [0] * 13 + [200]}, "left_j7 = 200 is outside"),
        ({"do": "sliders_to", "angles_deg": [90] * 14}, "right_j1 = 90 is outside"),
        ({"do": "timer", "action": "x"}, "choose from 'start'"),
        ({"do": "ratings", "operator": "x"}, "control must be one of"),
        ("x" * 5000, None),
        (b"\xff\xfe", None),  # no text: the connection is closed
    ],
)
def test_a_malformed_message_is_answered_and_the_arms_stand_still(message, answer):
    async def work(console):
        socket = await connect(console)
        error = await ask(socket, message)
        assert error is None if answer is None else answer in error
        await _stands_still(await connect(console))

    _served(work, Black)


class _Holes(FrameSource):
    """Depth of nothing but holes, until the camera is lost after a number of frames."""

    def __init__(self, frames):
        self.left = frames

    def read(self):
        if self.left == 0:
            raise InputError("camera 0 gives no more frames; check its cable and power")
        self.left -= 1
        colour, depth = np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16)
        return Frame(colour, depth, recorded_camera(), "holes")


def test_depth_of_holes_is_told_over_the_socket_and_the_arms_stand_still():
    async def work(console):
        socket = await connect(console)
        assert await ask(socket, {"do": "snapshot"}) == ""
        assert "nothing within reach" in await ask(socket, {"do": "click", "u": 320, "v": 240})
        await _stands_still(socket)

    _served(work, lambda: _Holes(10**6))


def test_a_lost_camera_is_told_over_the_socket_and_the_arms_stand_still():
    async def work(console):
        socket = await connect(console)
        while "check its cable" not in (await next_state(socket))["state"]["error"]:
            pass
        assert "check its cable" in await ask(socket, {"do": "snapshot"})
        assert "must be clicked" in await ask(socket, {"do": "confirm"})
        await _stands_still(socket)

    _served(work, lambda: _Holes(1))


def test_a_taken_port_is_refused():
    async def work(console):
        with pytest.raises(InputError, match="choose another --port"):
            Console(console.session, port=console.port)

    _served(work)


def test_a_joystick_over_the_socket_stops_with_the_browser_that_holds_it():
    async def work(console):
        first, second = await connect(console), await connect(console)
        await next_state(first)
        right = {"do": "joystick", "deflection": [40] + [0] * 13}
        assert "in control" in await ask(second, right)
        assert await ask(first, right) == ""
        assert await ask(first, {"do": "sliders_to", "angles_deg": [50] + [0] * 13}) != ""
        home = np.degrees(home_posture()[0])
        while (await next_state(first))["state"]["angles_deg"][0] <= home:
            assert await ask(first, right) == ""
        first.close()
        for moving in (True, False):  # what waits to be read tells how it began, too
            while bool((await next_state(second))["state"]["manual"]) is not moving:
                pass
        state = (await next_state(second))["state"]
        assert not state["valves_open"]
        await asyncio.sleep(0.2)
        np.testing.assert_array_equal((await next_state(second))["state"]["angles_deg"], state["angles_deg"])

    _served(work)


@pytest.mark.thorough
def test_a_task_stops_with_the_browser_in_control_and_the_next_one_resumes_it():
    async def work(console):
        first, second = await connect(console), await connect(console)
        await _click_the_pipe(first)
        assert await ask(first, {"do": "confirm"}) == ""
        while (await next_state(second))["state"]["mode"] != "running":
            pass
        first.close()
        while (await next_state(second))["state"]["mode"] != "stopped":
            pass
        state = await next_state(second)
        assert state["in_control"] and not state["state"]["valves_open"]
        assert await ask(second, {"do": "resume"}) == ""
        while (await next_state(second))["state"]["mode"] != "done":
            pass

    _served(work, rate=8.0)


def test_a_task_that_is_planned_for_a_lost_browser_does_not_begin():
    async def work(console):
        first, second = await connect(console), await connect(console)
        await _click_the_pipe(first)
        assert await ask(first, {"do": "confirm"}) == ""
        first.close()
        while (await next_state(second))["state"]["stage"] != "confirm":
            pass
        assert (await next_state(second))["state"]["mode"] == "idle"

    _served(work)


def test_trials_over_the_socket(tmp_path):
    async def work(console):
        console.trials = TrialLog(tmp_path)
        socket = await connect(console)
        ratings = {"do": "ratings", "operator": "7", "control": "assisted", **dict.fromkeys(SCALES, 25)}
        assert "no time to save" in await ask(socket, ratings)
        assert await ask(socket, {"do": "timer", "action": "start"}) == ""
        assert (await next_state(socket))["state"]["trial"]["running"]
        assert await ask(socket, {"do": "timer", "action": "stop"}) == ""
        assert await ask(socket, ratings) == ""
        assert (tmp_path / "trials.csv").read_text().splitlines()[1].endswith("25.00,")

    _served(work)


def test_the_page_s_scripts_and_its_policy():
    async def work(console):
        def get(name):
            return urllib.request.urlopen(f"http://127.0.0.1:{console.port}/{name}")

        loop = asyncio.get_running_loop()
        for name in ("charts.js", "manual.js", "trial.js"):
            assert "use strict" in (await loop.run_in_executor(None, get, name)).read().decode()
        icon = await loop.run_in_executor(None, get, "icon.svg")
        assert icon.headers["Content-Type"] == "image/svg+xml"
        page = await loop.run_in_executor(None, get, "")
        assert 'href="/icon.svg"' in page.read().decode()
        assert "frame-src" not in page.headers["Content-Security-Policy"]
        console.view_port = 7123
        page = await loop.run_in_executor(None, get, "")
        assert page.headers["Content-Security-Policy"].endswith("frame-src http://127.0.0.1:7123")

    _served(work)
