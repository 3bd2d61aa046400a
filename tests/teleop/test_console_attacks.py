"""The console against foreign pages, strangers, mute browsers and floods: nobody seizes it, and STOP always works."""

import asyncio
import json
import socket as sockets
import time

import numpy as np
import pytest
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect

from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.seats import Seats
from hydrolek_drake.teleop.console.server import Console
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.scene import home_posture

_RIGHT = {"do": "joystick", "deflection": [40] + [0] * 13}


class _Black(FrameSource):
    """Black pictures; each takes `seconds`."""

    seconds = 0.0

    def read(self):
        time.sleep(self.seconds)
        colour, depth = np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16)
        return Frame(colour, depth, recorded_camera(), "black")


def _served(work, source=_Black, **options):
    async def main():
        machine = Machine(home_posture(), realtime_rate=10.0)
        session = OperatorSession(source, machine, seed=1)
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


async def _open(console, *, token=True, headers=None):
    request = HTTPRequest(f"ws://127.0.0.1:{console.port}/socket", headers=headers or {})
    socket = await websocket_connect(request)
    if token:
        assert await _ask(socket, {"do": "token", "token": console.token}) == ""
    return socket


async def _ask(socket, message):
    await socket.write_message(json.dumps(message))
    while True:
        found = json.loads(await socket.read_message())
        if "error" in found:
            return found["error"]
        await socket.write_message('{"do": "here"}')


async def _state(socket, *, here=True):
    while True:
        found = json.loads(await socket.read_message())
        if "state" in found:
            if here:
                await socket.write_message('{"do": "here"}')
            return found


@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "evil.example", "Origin": "http://evil.example"},  # its name was rebound to 127.0.0.1
        {"Host": "evil.example:8080"},
        {"Host": "127.0.0.1.evil.example", "Origin": "http://127.0.0.1.evil.example"},
        {"Host": "127.0.0.1@evil.example"},
        {"Host": "192.168.0.5"},
        {"Host": "[::1"},
        {"Origin": "http://evil.example"},
        {"Origin": "http://127.0.0.1:1"},  # another server of this machine
        {"Origin": "null"},
        {"Origin": "http://["},
    ],
)
def test_a_foreign_page_is_not_let_in(headers):
    async def work(console, machine):
        with pytest.raises(HTTPClientError) as refused:
            await _open(console, headers=headers)
        assert refused.value.code in (400, 403)  # 400: no name at all
        if "Host" in headers:
            for page in ("", "colour.jpg", "manual.js", "nothing"):
                request = HTTPRequest(f"http://127.0.0.1:{console.port}/{page}", headers=headers)
                answer = await AsyncHTTPClient().fetch(request, raise_error=False)
                assert answer.code in (400, 403) and (answer.code == 400 or b"allow-host" in answer.body)
        assert not machine.state().valves_open

    _served(work)


def test_a_request_without_a_host_is_not_answered():
    async def work(console, machine):
        reader, writer = await asyncio.open_connection("127.0.0.1", console.port)
        writer.write(b"GET / HTTP/1.0\r\n\r\n")
        assert b"200" not in (await reader.read()).splitlines()[0]
        writer.close()

    _served(work)


@pytest.mark.parametrize(
    ("host", "allowed", "good", "bad"),
    [
        (
            "127.0.0.1",
            (),
            ["127.0.0.1:80", "localhost:80", "[::1]:80", "LOCALHOST."],
            ["robot", "10.0.0.1", ""],
        ),
        (
            "0.0.0.0",
            (),
            ["10.0.0.1:80", "[fe80::1]:80", "localhost"],
            ["robot", "evil.example", "10.0.0.1.x"],
        ),
        ("0.0.0.0", ("Robot.Example",), ["robot.example", "robot.example.:443"], ["robot", "evil.example"]),
        ("10.0.0.1", (), ["10.0.0.1"], ["10.0.0.2", "localhost"]),
        (
            "robot",
            (),
            ["robot:8080"],
            ["evil.example", "robot.evil.example", "a/robot", "robot#x", "robot:x"],
        ),
    ],
)
def test_names_under_which_the_console_is_served(host, allowed, good, bad):
    gate = Gate(host, allowed, "token")
    assert [gate.refused_host(header) for header in good] == [""] * len(good)
    assert all(gate.refused_host(header) for header in bad)


def test_a_proxy_s_name_is_a_good_origin():
    gate = Gate("127.0.0.1", ("robot.example",), "token")
    assert gate.refused_origin("https://robot.example", "127.0.0.1:8080") == ""
    assert gate.refused_origin("https://evil.example", "127.0.0.1:8080")


def test_without_the_token_one_watches_and_stops_but_moves_nothing():
    async def work(console, machine):
        stranger = await _open(console, token=False)
        found = await _state(stranger)
        assert found["state"] and not found["in_control"] and not found["trusted"]
        for message in (_RIGHT, {"do": "snapshot"}, {"do": "resume"}, {"do": "timer", "action": "start"}):
            assert "needs the token" in await _ask(stranger, message)
        assert "not the console's token" in await _ask(stranger, {"do": "token", "token": "x" * 24})
        operator = await _open(console)  # it came later, and has control all the same
        assert await _ask(operator, _RIGHT) == ""
        assert machine.state().manual
        assert await _ask(stranger, {"do": "stop"}) == ""
        assert not machine.state().manual and not machine.state().valves_open

    _served(work)


def test_bound_to_a_network_watching_needs_the_token_and_stop_does_not():
    async def work(console, machine):
        stranger = await _open(console, token=False)
        found = await _state(stranger)
        assert found["state"] is None and found["watching"] == 0
        for headers, code in (
            ({}, 401),
            ({"Authorization": "Bearer wrong"}, 401),
            ({"Authorization": f"Bearer {console.token}"}, 204),
        ):
            request = HTTPRequest(f"http://127.0.0.1:{console.port}/edges.jpg", headers=headers)
            assert (await AsyncHTTPClient().fetch(request, raise_error=False)).code == code
        operator = await _open(console)
        assert await _ask(operator, _RIGHT) == ""
        assert await _ask(stranger, {"do": "stop"}) == ""
        assert not machine.state().manual

    _served(work, host="0.0.0.0")


def test_a_mute_page_loses_control_and_what_it_held():
    async def work(console, machine):
        console.seats._mute = 1.0
        mute, operator = await _open(console), await _open(console)
        assert await _ask(mute, _RIGHT) == ""
        assert "in control" in await _ask(operator, _RIGHT)
        end = time.monotonic() + 5.0  # pings are answered all the while, states are not
        while not (await _state(operator))["in_control"]:
            assert time.monotonic() < end
        assert not machine.state().manual
        assert await _ask(operator, _RIGHT) == ""
        assert "in control" in await _ask(mute, _RIGHT)

    _served(work)


class _Browser:
    def __init__(self, trusted=True):
        self.trusted = trusted


def test_control_goes_down_the_line_and_comes_back_to_who_answers_again():
    now, losses = [0.0], []
    seats = Seats(5.0, lambda: losses.append(now[0]), clock=lambda: now[0])
    stranger, first, second = _Browser(trusted=False), _Browser(), _Browser()
    for each in (stranger, first, second):
        seats.enter(each)
    assert seats.holder() is first
    for each in (first, second):
        seats.asked(each)
    seats.heard(second)
    now[0] = 4.9
    assert seats.holder() is first
    now[0] = 5.1
    assert seats.holder() is second and losses == [5.1]
    seats.heard(first)
    seats.leave(second)
    assert seats.holder() is first and losses == [5.1, 5.1]
    seats.leave(first)
    assert seats.holder() is None


def test_who_is_sent_no_state_is_not_mute():
    now = [0.0]
    seats = Seats(5.0, lambda: None, clock=lambda: now[0])
    first = _Browser()
    seats.enter(first)
    assert seats.holder() is first
    now[0] = 100.0
    assert seats.holder() is first


def test_stop_waits_for_no_camera():
    class Slow(_Black):
        seconds = 3.0

    async def work(console, machine):
        operator, watcher = await _open(console), await _open(console)
        assert await _ask(operator, _RIGHT) == ""
        for _ in range(3):  # both workers are busy
            await operator.write_message('{"do": "snapshot"}')
        await asyncio.sleep(0.1)
        began = time.monotonic()
        await operator.write_message('{"do": "stop"}')
        await watcher.write_message('{"do": "stop"}')
        while machine._hand._blocked is False:
            assert time.monotonic() - began < 1.0
            await asyncio.sleep(0.01)

    _served(work, source=Slow)


def test_a_flood_is_answered_and_stop_is_heard():
    async def work(console, machine):
        operator, flooder = await _open(console), await _open(console, token=False)
        for _ in range(2000):
            flooder.write_message('{"do": "snapshot"}')
        for _ in range(200):
            operator.write_message('{"do": "snapshot"}')
        assert "too many messages" in await _until_error(operator, "too many")
        began = time.monotonic()
        await operator.write_message('{"do": "stop"}')
        while machine._hand._blocked is False:
            assert time.monotonic() - began < 2.0
            await asyncio.sleep(0.01)

    _served(work)


async def _until_error(socket, wanted):
    while True:
        error = json.loads(await socket.read_message()).get("error", "")
        if wanted in error:
            return error


def test_slow_requests_are_ended_and_too_many_connections_refused():
    async def work(console, machine):
        loop = asyncio.get_running_loop()
        console._server.conn_params.header_timeout = 1.0
        slow = []
        for _ in range(100):
            connection = sockets.create_connection(("127.0.0.1", console.port), timeout=5.0)
            connection.sendall(b"GET / HTTP/1.1\r\nHost: ")
            slow.append(connection)
            await asyncio.sleep(0)
        closed = await loop.run_in_executor(None, lambda: [_ended(each) for each in slow])
        assert all(closed)
        operator = await _open(console)
        assert await _ask(operator, {"do": "stop"}) == ""

    _served(work)


def _ended(connection):
    with connection:
        try:
            return connection.recv(100) == b""
        except ConnectionResetError:
            return True
        except TimeoutError:
            return False


def test_what_fails_while_states_are_sent_ends_nothing(caplog):
    async def work(console, machine):
        operator = await _open(console)
        state, failures = console.session.state, [RuntimeError("broken")]

        def fails():
            if failures:
                raise failures.pop()
            return state()

        console.session.state = fails
        while failures:
            await asyncio.sleep(0.01)
        assert (await _state(operator))["in_control"]

    _served(work)
    assert "states failed" in caplog.text


def test_the_page_lies_in_no_frame_of_another_site():
    async def work(console, machine):
        answer = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{console.port}/")
        assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
        assert answer.headers["Referrer-Policy"] == "no-referrer"
        assert console.token not in answer.body.decode()

    _served(work)
