"""What a browser says to the console, against the real server."""

import asyncio
import functools
import json
import threading
from pathlib import Path
from typing import Any

import numpy as np
from tornado.websocket import WebSocketClosedError, websocket_connect

from fuzzing.byte_damage import damaged
from fuzzing.json_messages import GOOD_MESSAGES, JSON_PIECES, JSON_RAW, as_json
from fuzzing.target import Input, Target
from fuzzing.tree_damage import changed_tree
from hydrolek_drake.teleop.console.server import Console
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.scene import home_posture

_ANSWER_S = 5.0  # until an answer counts as missing

_JSON_WORDS = (
    "do", "name", "token", "u", "v", "deflection", "angles_deg", "action", "snapshot", "stop", "here", "click",
    "sliders", "low_contrast", "mental", "operator", "note", "surfaces", "cut", "start", "reset", "__class__",
    "constructor", "state",
)  # fmt: skip


def _console_input(rng: np.random.Generator) -> Input:
    good = GOOD_MESSAGES[rng.integers(len(GOOD_MESSAGES))]
    data = as_json(*changed_tree(good, _JSON_WORDS, JSON_PIECES, rng, JSON_RAW)).encode(
        "utf-8", "surrogatepass"
    )
    if rng.random() < 0.25:
        data = damaged(data, [json.dumps(each).encode() for each in GOOD_MESSAGES], rng)
    return Input("message.json", data[:4000])


class _Black(FrameSource):
    def read(self) -> Frame:
        colour, depth = np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16)
        return Frame(colour, depth, recorded_camera(), "black")


class _Served:
    """A console that is served in a thread of its own, with a page that is in control and one that watches."""

    def __init__(self) -> None:
        self.loop = asyncio.new_event_loop()
        ready = threading.Event()

        def serve() -> None:
            asyncio.set_event_loop(self.loop)
            self.loop.run_until_complete(self._begin())
            ready.set()
            self.loop.run_forever()

        self._thread = threading.Thread(target=serve, daemon=True)
        self._thread.start()
        assert ready.wait(60.0)

    def close(self) -> None:
        """End what runs."""
        asyncio.run_coroutine_threadsafe(self._end(), self.loop).result(_ANSWER_S)
        self.session.close()
        self.machine.close()
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join(_ANSWER_S)

    async def _end(self) -> None:
        self._running.cancel()
        self.console.close()

    async def _begin(self) -> None:
        self.machine = Machine(home_posture(), realtime_rate=10.0)
        self.session = OperatorSession(_Black, self.machine, seed=1)
        self.console = Console(self.session, port=0)
        self._running = asyncio.ensure_future(self.console.run())

    def ask(self, data: bytes) -> list[str]:
        """Errors that a message and a stop behind it are answered with."""
        return asyncio.run_coroutine_threadsafe(self._ask(data), self.loop).result(2 * _ANSWER_S)

    async def _ask(self, data: bytes) -> list[str]:
        page = await websocket_connect(f"ws://127.0.0.1:{self.console.port}/socket")
        errors: list[str] = []
        try:
            await page.write_message(json.dumps({"do": "token", "token": self.console.token}))
            errors.append(await self._answer(page))
            try:
                text: str | bytes = data.decode("utf-8")
                await page.write_message(text)
            except UnicodeDecodeError:
                await page.write_message(data, binary=True)
            if data_is(data, "here"):
                errors.append("")
            else:
                errors.append(await self._answer(page))
            await page.write_message('{"do": "stop"}')
            errors.append(await self._answer(page))
        finally:
            page.close()
        return errors

    async def _answer(self, page: Any) -> str:
        while True:
            found = await asyncio.wait_for(page.read_message(), _ANSWER_S)
            if found is None:
                raise WebSocketClosedError
            told = json.loads(found)
            if "error" in told:
                return str(told["error"])


def data_is(data: bytes, what: str) -> bool:
    """Whether a message is one without an answer: the page lives."""
    try:
        found = json.loads(data)
    except (ValueError, RecursionError):
        return False
    return isinstance(found, dict) and found == {"do": what}


@functools.cache
def _console() -> _Served:
    return _Served()


def _talk_to_console(path: Path) -> str:
    served = _console()
    first, error, last = served.ask(path.read_bytes())
    assert first == "", f"the token is not heeded: {first}"
    assert not error.startswith(("it failed", "STOP failed")), error
    assert last == "", f"STOP is not heeded: {last}"
    assert error.isprintable() and len(error) < 1000, f"answered {error[:200]!r}"
    assert not served.machine.state().valves_open, "the valves are open after STOP"
    return "refused" if error else "carried out"


def _console_seeds() -> list[Input]:
    return [Input("message.json", json.dumps(each).encode()) for each in GOOD_MESSAGES[:2]]


def _end() -> None:
    if _console.cache_info().currsize:
        _console().close()
        _console.cache_clear()


TARGETS = (Target("console", _console_input, _talk_to_console, _console_seeds, end=_end),)
