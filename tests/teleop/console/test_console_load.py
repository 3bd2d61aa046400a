"""The console under load: a slow camera, floods, slow requests and failures keep nobody from STOP."""

import asyncio
import json
import socket as sockets
import time

from console_client import TO_THE_RIGHT, Black, ask, connect, next_state, served


def test_stop_waits_for_no_camera():
    class Slow(Black):
        seconds = 3.0

    async def work(console, machine):
        operator, watcher = await connect(console), await connect(console)
        assert await ask(operator, TO_THE_RIGHT) == ""
        for _ in range(3):  # both workers are busy
            await operator.write_message('{"do": "snapshot"}')
        await asyncio.sleep(0.1)
        began = time.monotonic()
        await operator.write_message('{"do": "stop"}')
        await watcher.write_message('{"do": "stop"}')
        while machine._hand._blocked is False:
            assert time.monotonic() - began < 1.0
            await asyncio.sleep(0.01)

    served(work, source=Slow)


def test_a_flood_is_answered_and_stop_is_heard():
    async def work(console, machine):
        operator, flooder = await connect(console), await connect(console, token=False)
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

    served(work)


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
        operator = await connect(console)
        assert await ask(operator, {"do": "stop"}) == ""

    served(work)


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
        operator = await connect(console)
        state, failures = console.session.state, [RuntimeError("broken")]

        def fails():
            if failures:
                raise failures.pop()
            return state()

        console.session.state = fails
        while failures:
            await asyncio.sleep(0.01)
        assert (await next_state(operator))["in_control"]

    served(work)
    assert "states failed" in caplog.text


def test_what_was_asked_for_before_a_stop_is_not_done_after_it():
    """Clicks that take their time hold the rest up; a joystick that is released among them must not open anything."""

    class Slow(Black):
        seconds = 1.0

    async def work(console, machine):
        operator, watcher = await connect(console), await connect(console)
        assert await ask(operator, TO_THE_RIGHT) == ""
        await operator.write_message('{"do": "snapshot"}')
        await asyncio.sleep(0.1)
        await operator.write_message('{"do": "let_go"}')
        await operator.write_message(TO_THE_RIGHT)
        await watcher.write_message('{"do": "stop"}')
        await _until_error(operator, "STOP came after it")
        await asyncio.sleep(0.3)
        assert machine._hand._blocked and not machine.state().valves_open

    served(work, source=Slow)
