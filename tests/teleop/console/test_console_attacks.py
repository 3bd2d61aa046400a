"""The console against foreign pages, strangers and mute browsers: nobody seizes it, and anybody stops it."""

import asyncio
import time

import pytest
from console_client import TO_THE_RIGHT, ask, connect, next_state, served
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest

from hydrolek_drake.teleop.console.gate import Gate
from hydrolek_drake.teleop.console.seats import Seats


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
            await connect(console, headers=headers)
        assert refused.value.code in (400, 403)  # 400: no name at all
        if "Host" in headers:
            for page in ("", "colour.jpg", "manual.js", "nothing"):
                request = HTTPRequest(f"http://127.0.0.1:{console.port}/{page}", headers=headers)
                answer = await AsyncHTTPClient().fetch(request, raise_error=False)
                assert answer.code in (400, 403) and (answer.code == 400 or b"allow-host" in answer.body)
        assert not machine.state().valves_open

    served(work)


def test_a_request_without_a_host_is_not_answered():
    async def work(console, machine):
        reader, writer = await asyncio.open_connection("127.0.0.1", console.port)
        writer.write(b"GET / HTTP/1.0\r\n\r\n")
        assert b"200" not in (await reader.read()).splitlines()[0]
        writer.close()

    served(work)


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
        stranger = await connect(console, token=False)
        found = await next_state(stranger)
        assert found["state"] and not found["in_control"] and not found["trusted"]
        for message in (
            TO_THE_RIGHT,
            {"do": "snapshot"},
            {"do": "resume"},
            {"do": "timer", "action": "start"},
        ):
            assert "needs the token" in await ask(stranger, message)
        assert "not the console's token" in await ask(stranger, {"do": "token", "token": "x" * 24})
        operator = await connect(console)  # it came later, and has control all the same
        assert await ask(operator, TO_THE_RIGHT) == ""
        assert machine.state().manual
        assert await ask(stranger, {"do": "stop"}) == ""
        assert not machine.state().manual and not machine.state().valves_open

    served(work)


def test_bound_to_a_network_watching_needs_the_token_and_stop_does_not():
    async def work(console, machine):
        stranger = await connect(console, token=False)
        found = await next_state(stranger)
        assert found["state"] is None and found["watching"] == 0
        for headers, code in (
            ({}, 401),
            ({"Authorization": "Bearer wrong"}, 401),
            ({"Authorization": f"Bearer {console.token}"}, 204),
        ):
            request = HTTPRequest(f"http://127.0.0.1:{console.port}/edges.jpg", headers=headers)
            assert (await AsyncHTTPClient().fetch(request, raise_error=False)).code == code
        operator = await connect(console)
        assert await ask(operator, TO_THE_RIGHT) == ""
        assert await ask(stranger, {"do": "stop"}) == ""
        assert not machine.state().manual

    served(work, host="0.0.0.0")


def test_a_mute_page_loses_control_and_what_it_held():
    async def work(console, machine):
        console.seats._mute = 1.0
        mute, operator = await connect(console), await connect(console)
        assert await ask(mute, TO_THE_RIGHT) == ""
        assert "in control" in await ask(operator, TO_THE_RIGHT)
        end = time.monotonic() + 5.0  # pings are answered all the while, states are not
        while not (await next_state(operator))["in_control"]:
            assert time.monotonic() < end
        assert not machine.state().manual
        assert await ask(operator, TO_THE_RIGHT) == ""
        assert "in control" in await ask(mute, TO_THE_RIGHT)

    served(work)


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


def test_the_page_lies_in_no_frame_of_another_site():
    async def work(console, machine):
        answer = await AsyncHTTPClient().fetch(f"http://127.0.0.1:{console.port}/")
        assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
        assert answer.headers["Referrer-Policy"] == "no-referrer"
        assert console.token not in answer.body.decode()

    served(work)


def test_strangers_do_not_keep_an_operator_out():
    async def work(console, machine):
        strangers = [await connect(console, token=False) for _ in range(console.most)]
        operator = await connect(console)
        assert await ask(operator, TO_THE_RIGHT) == ""
        assert len(console.seats.browsers) <= console.most and len(strangers) == console.most

    served(work)
