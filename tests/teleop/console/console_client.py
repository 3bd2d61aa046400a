"""A console that is served for a test, and what a browser sends it and reads from it."""

import asyncio
import json
import time

import numpy as np
from tornado.httpclient import HTTPRequest
from tornado.websocket import websocket_connect

from hydrolek_drake.teleop.console.server import Console
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.scene import home_posture

TO_THE_RIGHT = {"do": "joystick", "deflection": [40] + [0] * 13}


class Black(FrameSource):
    """Black pictures; each takes `seconds`."""

    seconds = 0.0

    def read(self):
        time.sleep(self.seconds)
        colour, depth = np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16)
        return Frame(colour, depth, recorded_camera(), "black")


def served(work, source=Black, *, rate=10.0, stand=None, **options):
    """Run `work(console, machine)` against a console with a machine so much faster than real time."""

    async def main():
        machine = Machine(home_posture(), realtime_rate=rate)
        session = OperatorSession(source, machine, seed=1, stand=stand)
        console = Console(session, port=0, **options)
        running = asyncio.ensure_future(console.run())
        try:
            await asyncio.wait_for(work(console, machine), 60.0)
        finally:
            running.cancel()
            console.close()
            machine.close()
            session.close()

    asyncio.run(main())


async def connect(console, *, token=True, headers=None):
    """A browser's socket, which has given the token unless it is to be a stranger's."""
    request = HTTPRequest(f"ws://127.0.0.1:{console.port}/socket", headers=headers or {})
    socket = await websocket_connect(request)
    if token:
        assert await ask(socket, {"do": "token", "token": console.token}) == ""
    return socket


async def ask(socket, message, seen=None):
    """Send and return the error that is answered: empty for none, None where the connection is closed.

    Steps of the task on the way go into `seen`.
    """
    await socket.write_message(message if isinstance(message, (str, bytes)) else json.dumps(message))
    while True:
        answer = await socket.read_message()
        if answer is None:
            return None
        found = json.loads(answer)
        if "error" in found:
            return found["error"]
        await socket.write_message('{"do": "here"}')
        if seen is not None and found["state"] is not None:
            seen.add(found["state"]["step"])


async def next_state(socket):
    """The next state that is sent, answered as the page does."""
    while True:
        found = json.loads(await socket.read_message())
        if "state" in found:
            await socket.write_message('{"do": "here"}')
            return found
