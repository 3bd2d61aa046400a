"""The link among peers that reset, stall, flood or interfere: it goes on, and the valves are closed when in doubt."""

import errno
import logging
import os
import signal
import socket
import struct
import subprocess
import sys
import time

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.link.messages import encode
from hydrolek_drake.teleop.link.server import SetpointServer
from hydrolek_drake.teleop.link.signals import Signals
from hydrolek_drake.workcell.scene import home_posture

MUTE = teleop_entries("link")["mute"]


@pytest.fixture
def server():
    server = SetpointServer(home_posture(), port=0)
    yield server
    server.close()


def _until(condition, limit=5.0):
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, f"did not happen within {limit:g} s"
        time.sleep(0.005)


def _answered(ask):
    """Whether a question is answered and not refused."""
    try:
        ask()
    except InputError:
        return False
    return True


def _connection(server):
    return socket.create_connection(("127.0.0.1", server.port), timeout=5.0)


def _reset(connection):
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
    connection.close()


def _asked(connection, message):
    connection.sendall(message)
    answer = b""
    while not answer.endswith(b"\n"):
        received = connection.recv(4096)
        if not received:
            break
        answer += received
    return answer


def test_two_hundred_resets_beside_a_client_in_control_do_not_disturb_it(server):
    client = SetpointClient(server.port)
    client.send(home_posture())
    for number in range(200):
        peer = _connection(server)
        if number % 2:
            peer.sendall(b"STATUS\n" * 20)
        _reset(peer)
        if number % 20 == 0:
            client.send(home_posture())
    client.send(home_posture())
    assert server.command()[1]
    client.close()
    again = SetpointClient(server.port)
    _until(
        lambda: _answered(lambda: again.send(home_posture()))
    )  # once the server knows that the other has left
    assert server.command()[1]
    again.close()


def test_a_reset_of_the_client_in_control_closes_the_valves_and_frees_the_seat(server):
    peer = _connection(server)
    _asked(peer, encode(home_posture()))
    assert server.command()[1]
    _reset(peer)
    _until(lambda: not server.command()[1])
    client = SetpointClient(server.port)
    client.send(home_posture())
    assert server.command()[1]
    client.close()


def test_a_mute_client_loses_control_and_its_connection(server):
    mute = _connection(server)
    _asked(mute, encode(home_posture()))
    client = SetpointClient(server.port)
    with pytest.raises(InputError, match="another client is in control"):
        client.control()
    began = time.monotonic()
    _until(lambda: _answered(client.control))
    assert time.monotonic() - began < MUTE + 1.0
    client.send(home_posture())
    assert server.command()[1]
    assert b"no whole message" in mute.recv(4096)
    mute.close()
    client.close()


def test_a_stopped_process_loses_control(server):
    program = (
        "import sys, time\n"
        "from hydrolek_drake.teleop.link.client import SetpointClient\n"
        "from hydrolek_drake.workcell.scene import home_posture\n"
        "client = SetpointClient(int(sys.argv[1]))\n"
        "while True:\n"
        "    client.send(home_posture())\n"
        "    time.sleep(0.05)\n"
    )
    process = subprocess.Popen([sys.executable, "-c", program, str(server.port)], stderr=subprocess.DEVNULL)
    try:
        _until(lambda: server.command()[1], 60.0)
        os.kill(process.pid, signal.SIGSTOP)
        _until(lambda: not server.command()[1])
        client = SetpointClient(server.port)
        with pytest.raises(InputError, match="in control"):
            client.control()
        _until(lambda: _answered(client.control))  # asked all the while, so that it is not mute itself
        client.send(home_posture())
        assert server.command()[1]
        os.kill(process.pid, signal.SIGCONT)  # it wakes, and is refused
        _until(lambda: _answered(lambda: client.send(home_posture())) and process.poll() is not None, 10.0)
        assert process.returncode != 0 and server.command()[1]
        client.close()
    finally:
        process.kill()
        process.wait()


def test_a_message_that_comes_byte_by_byte_does_not_hold_a_connection(server):
    peer = _connection(server)
    began = time.monotonic()
    line = encode(home_posture())
    with pytest.raises((BrokenPipeError, ConnectionResetError, AssertionError)):
        for place in range(len(line) - 1):
            peer.sendall(line[place : place + 1])
            time.sleep(0.1)
            if time.monotonic() - began > MUTE + 1.0:
                assert peer.recv(4096) == b""  # ended by the server
    assert time.monotonic() - began < MUTE + 3.0
    peer.close()


def test_a_peer_that_never_reads_is_dropped(server):
    wide = np.full(14, 1.0 / 3.0)  # answers that fill the buffers soon
    server.report(home_posture(), Signals(0.0, wide, wide, wide, wide, 0.0, np.zeros(2)))
    peer = _connection(server)
    peer.settimeout(0.2)
    end = time.monotonic() + 30.0
    dropped = False
    while not dropped and time.monotonic() < end:
        try:
            peer.sendall(b"SIGNALS\n" * 500)
        except TimeoutError:
            continue
        except OSError:
            dropped = True
    assert dropped
    client = SetpointClient(server.port)
    client.send(home_posture())
    client.close()


def test_too_many_connections_are_refused_and_the_one_in_control_goes_on(server):
    client = SetpointClient(server.port)
    client.send(home_posture())
    others = [_connection(server) for _ in range(int(teleop_entries("link")["connections"]))]
    assert b"too many connections" in others[-1].recv(4096)
    client.send(home_posture())
    for each in others:
        each.close()
    client.close()


def test_a_second_client_reads_and_stops_but_does_not_lead(server):
    client, other = SetpointClient(server.port), _connection(server)
    client.send(home_posture())
    assert _asked(other, b"STATUS\n") == b"STATUS,1,0,\n"
    assert _asked(other, b"SIGNALS\n") == b"{}\n"
    assert _asked(other, encode(home_posture())).startswith(b"BUSY")
    assert server.command()[1]
    _asked(other, b"STOP\n")
    assert server.command()[1:] == (False, "stopped by another client")
    with pytest.raises(InputError, match="stopped by another client"):
        client.send(home_posture())
    again = SetpointClient(server.port)
    with pytest.raises(InputError, match="send CONTROL"):
        again.send(home_posture())
    assert not server.command()[1]
    again.control()
    again.send(home_posture())
    assert server.command()[1]
    again.close()
    other.close()


def test_a_browser_s_request_is_a_bad_message(server):
    client, browser = SetpointClient(server.port), _connection(server)
    client.send(home_posture())
    body = encode(home_posture())
    answer = _asked(browser, b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n" + body)
    assert answer.startswith(b"ERROR") and not server.command()[1]
    browser.close()
    client.close()


def test_without_the_token_only_stop_is_heeded():
    server = SetpointServer(home_posture(), port=0, token="right")
    try:
        for message in (encode(home_posture()), b"CONTROL\n", b"SIGNALS\n", b"TOKEN wrong\n", b"TOKEN\n"):
            stranger = _connection(server)
            assert _asked(stranger, message).startswith(b"ERROR")
            stranger.close()
        assert not server.command()[1]
        with pytest.raises(InputError, match="not the token"):
            SetpointClient(server.port, token="wrong")
        client = SetpointClient(server.port, token="right")
        client.send(home_posture())
        assert server.command()[1]
        stranger = _connection(server)
        _asked(stranger, b"STOP\n")
        assert not server.command()[1]
        stranger.close()
        client.close()
    finally:
        server.close()


def test_answers_end_as_requests_do_and_the_version_is_told(server):
    peer = _connection(server)
    assert _asked(peer, b"VERSION\r\n") == b"VERSION 1\r\n"
    assert _asked(peer, encode(home_posture())[:-1] + b"\r\n").count(b",") == 13
    assert _asked(peer, b"STATUS\r\n") == b"STATUS,1,1,\r\n"
    assert _asked(peer, b"ALIVE\r\n").endswith(b"\r\n")
    assert _asked(peer, b"VERSION 7\n").startswith(b"ERROR")
    peer.close()


@pytest.mark.parametrize("error", [RuntimeError("no more threads"), OSError(errno.EMFILE, "too many files")])
def test_a_failure_of_listening_is_told_and_mended(server, error, monkeypatch, caplog):
    listener = type(server._listener)
    accept, failures = listener.get_request, [error, error]

    def fails(self):
        if failures:
            raise failures.pop()
        return accept(self)

    monkeypatch.setattr(listener, "get_request", fails)
    with caplog.at_level(logging.ERROR):
        client = SetpointClient(server.port)
        client._patience = 3.0
        client.send(home_posture())
    assert server.command()[1] and not failures
    if isinstance(error, RuntimeError):
        assert "begins again" in caplog.text
    client.close()


@pytest.mark.parametrize(
    "answer", [b"1,2,3\n", b"nan" + b",0" * 13 + b"\n", b"\xff\n", b"9" * 70000, b"ERROR so it is\n", b"\n"]
)
def test_a_bad_answer_is_told_by_the_client(answer):
    with socket.create_server(("127.0.0.1", 0)) as listener:
        client = SetpointClient(listener.getsockname()[1])
        peer, _ = listener.accept()
        peer.sendall(answer)
        with pytest.raises(InputError, match="link: "):
            client.stop()
        peer.close()
        client.close()


def test_closing_at_once_is_no_deadlock():
    for _ in range(20):
        server = SetpointServer(np.zeros(14), port=0)
        server.close()
        with pytest.raises(OSError):  # nobody listens any more
            socket.create_connection(("127.0.0.1", server.port), timeout=1.0)
