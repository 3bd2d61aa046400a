"""The link: set points through, and every way to lose it closes the valves."""

import socket
import time

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.link.messages import Word, decode, encode
from hydrolek_drake.teleop.link.server import SetpointServer, silence
from hydrolek_drake.teleop.link.signals import Signals, signals_from_line
from hydrolek_drake.workcell.scene import home_posture


@pytest.fixture
def server():
    server = SetpointServer(home_posture(), port=0)
    yield server
    server.close()


def _until(condition):
    limit = time.monotonic() + 3.0
    while not condition():
        assert time.monotonic() < limit, "did not happen within 3 s"
        time.sleep(0.005)


def test_valves_are_closed_until_set_points_come(server):
    assert server.command()[1] is False
    client = SetpointClient(server.port)
    wanted = home_posture() + 0.01
    client.send(wanted)
    desired, open_, reason = server.command()
    np.testing.assert_allclose(desired, wanted, atol=1e-6)
    assert open_ and reason == ""
    client.close()


def test_the_answer_is_the_measured_position(server):
    client = SetpointClient(server.port)
    server.report(home_posture() + 0.02)
    np.testing.assert_allclose(client.send(home_posture()), home_posture() + 0.02, atol=1e-6)
    client.close()


def test_stop_closes_the_valves_and_set_points_open_them_again(server):
    client = SetpointClient(server.port)
    client.send(home_posture())
    client.stop()
    assert server.command()[1:] == (False, "stopped by the operator")
    client.send(home_posture())
    assert server.command()[1]
    client.close()


def test_a_client_that_leaves_closes_the_valves(server):
    client = SetpointClient(server.port)
    client.send(home_posture())
    client.close()
    _until(lambda: not server.command()[1])
    assert "gone" in server.command()[2]


def test_silence_closes_the_valves(server):
    client = SetpointClient(server.port)
    client.send(home_posture())
    assert server.command()[1]
    time.sleep(teleop_entries("link")["silence"] + 0.1)
    assert server.command()[1:] == (False, "no message for 0.5 s")
    client.close()


def test_silence_is_counted_in_the_time_of_the_machine():
    assert silence(1.0) == teleop_entries("link")["silence"]
    assert silence(0.5) == 2 * silence(1.0)
    assert silence(4.0) == silence(1.0)  # a fast simulation leaves the computers no less time
    server = SetpointServer(home_posture(), port=0, realtime_rate=0.5)
    client = SetpointClient(server.port, realtime_rate=0.5)
    client.send(home_posture())
    time.sleep(silence(1.0) + 0.1)
    assert server.command()[1]
    time.sleep(silence(1.0))
    assert not server.command()[1]
    client.close()
    server.close()


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"hello\n", "is not 14 angles"),
        (b"1,2,3\n", "3 angles"),
        (encode(home_posture()).rsplit(b",", 1)[0] + b",nan\n", "left_j7 = nan deg"),
        (b",".join([b"0"] * 2 + [b"80"] + [b"0"] * 11) + b"\n", "right_j3 = 80 deg is outside"),
        (b"\xff\xfe\n", "is not 14 angles"),
        (b"0," * 5000, "longer than 512 bytes"),
        (b"9" * 2000 + b"\n", "longer than 512 bytes"),
    ],
)
def test_a_bad_message_closes_the_valves_and_leaves_the_set_point(server, message, reason):
    with socket.create_connection(("127.0.0.1", server.port)) as raw:
        raw.sendall(encode(home_posture()))
        raw.recv(4096)
        assert server.command()[1]
        raw.sendall(message)
        _until(lambda: not server.command()[1])
    assert reason in server.command()[2]
    np.testing.assert_allclose(server.command()[0], home_posture(), atol=1e-6)


def test_a_message_in_pieces_is_one_message(server):
    line = encode(home_posture() + 0.01)
    with socket.create_connection(("127.0.0.1", server.port)) as raw:
        for part in (line[:10], line[10:50], line[50:]):
            raw.sendall(part)
            time.sleep(0.02)
        raw.recv(4096)
        np.testing.assert_allclose(server.command()[0], home_posture() + 0.01, atol=1e-6)


def test_a_second_client_is_refused_and_the_first_goes_on(server):
    first = SetpointClient(server.port)
    first.send(home_posture())
    second = SetpointClient(server.port)
    with pytest.raises(InputError, match="another client is in control"):
        second.send(home_posture() + 0.1)
    first.send(home_posture())
    np.testing.assert_allclose(server.command()[0], home_posture(), atol=1e-6)
    first.close()


def test_without_controllers_and_with_a_taken_port_the_reason_is_given(server):
    with pytest.raises(InputError, match="choose another port"):
        SetpointServer(home_posture(), port=server.port)
    free = socket.create_server(("127.0.0.1", 0))
    port = free.getsockname()[1]
    free.close()
    with pytest.raises(InputError, match="no controllers answer"):
        SetpointClient(port)


def test_encoding_is_in_degrees_and_exact_to_a_ten_thousandth():
    np.testing.assert_allclose(decode(encode(home_posture())).angles, home_posture(), atol=1e-6)
    assert encode(home_posture()).startswith(b"-20.0000,20.0000,")
    assert decode(b"STOP").word is Word.STOP


def test_deflections_open_the_valves_and_set_points_take_over(server):
    client = SetpointClient(server.port)
    client.rate([25.0, *[0.0] * 13])
    order = server.order()
    assert order.valves_open and order.deflection[0] == 25.0
    np.testing.assert_array_equal(order.desired, home_posture())
    client.send(home_posture())
    assert server.order().deflection is None and server.order().valves_open
    client.rate(np.zeros(14))
    client.stop()
    assert server.order().deflection is None and not server.order().valves_open
    client.close()


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"RATE,1,2\n", "2 deflections; 14"),
        (b"RATE" + b",0" * 13 + b",101\n", "deflection of left_j7 = 101 %"),
        (b"RATE" + b",0" * 13 + b",nan\n", "deflection of left_j7 = nan %"),
        (b"RATE" + b",x" * 14 + b"\n", "is not 14 angles in degrees, RATE and 14"),
    ],
)
def test_a_bad_deflection_closes_the_valves(server, message, reason):
    with socket.create_connection(("127.0.0.1", server.port)) as raw:
        raw.sendall(encode(home_posture()))
        raw.recv(4096)
        raw.sendall(message)
        _until(lambda: not server.command()[1])
    assert reason in server.command()[2]


def test_signals_are_answered_as_sent_and_open_nothing(server):
    client = SetpointClient(server.port)
    assert client.signals() is None and not server.command()[1]
    vectors = np.arange(14.0)
    sent = Signals(
        1.25,
        vectors,
        1e6 + vectors,
        2e6 + vectors,
        np.full(14, np.nan),
        1.6e7,
        np.array([1.5, 0.0]),
        pipe_place=np.array([1.8, 0.1, 1.0, 0.0, 0.6, 0.8]),
        pace=0.98,
    )
    server.report(home_posture(), sent)
    got = client.signals()
    for name in (
        "time",
        "supply_pressure",
        "pace",
        "grip",
        "pipe_place",
        "voltage",
        "pressure_a",
        "pressure_b",
        "potentiometer",
    ):
        np.testing.assert_allclose(getattr(got, name), getattr(sent, name), rtol=1e-6)
    assert server.command()[1:] == (False, "no client yet")
    client.close()


@pytest.mark.parametrize("line", [b"[]", b"x", b'{"time": 1}', b"null"])
def test_what_is_no_signals_is_refused(line):
    with pytest.raises(InputError, match="no line of signals"):
        signals_from_line(line)
