"""Lines to the link, against the real server, and from it."""

import functools
import json
import re
import socket
import time
from pathlib import Path

import numpy as np

from fuzzing.byte_damage import damaged
from fuzzing.json_messages import JSON_PIECES, JSON_RAW, as_json
from fuzzing.target import Input, Target
from fuzzing.tree_damage import changed_tree
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.link.messages import decode_answer, encode, encode_rate
from hydrolek_drake.teleop.link.server import SetpointServer
from hydrolek_drake.teleop.link.signals import Signals, signals_from_line
from hydrolek_drake.workcell.scene import home_posture

_ENDED_S = 5.0  # until a connection counts as one that does not end
_ANSWER_S = 1.0  # until an answer counts as missing; the link ends a connection that is silent for 2 s
_LINE = "line.bin"

_WORDS = (
    "STOP", "CONTROL", "RATE", "ALIVE", "SIGNALS", "STATUS", "VERSION", "VERSION 1", "VERSION 2", "TOKEN",
    "TOKEN x", "stop", "STOP ", " STOP", "STOP,", "STOPX", "RATEX", "RATE,", "RATE 0", "HELLO",
    "GET / HTTP/1.1", "BUSY", "ERROR", "",
)  # fmt: skip
_NUMBERS = (
    "0", "-0", "1", "1.", ".5", "1e1", "1e-300", "1e300", "1e999", "-1e999", "nan", "inf", "-inf", "infinity",
    "1_0", "0x10", "1,5", "1;5", "", " ", " 1 ", "+1", "--1", "١", "1" * 60, "180", "-180", "360", "90.0001",
    "x", "\t1", "1\x00", "True",
)  # fmt: skip
_ODD = (
    b"\r",
    b"\n",
    b"\x00",
    b"\xff",
    b"\r\n\r\n",
    b"\xc3\xa9",
    b" ",
    b",",
    b"\x0b",
    b"\x1c",
    b"\x85",
    b"A" * 600,
)

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_GOOD_WORDS = {"STOP", "CONTROL", "ALIVE", "SIGNALS", "STATUS", "VERSION", "VERSION 1"}
_FULL_PERCENT, _ROUNDING_DEG = 100.0, 1e-3


def _line_of(rng: np.random.Generator) -> bytes:
    """A line for the link, more or less as it should be."""
    good = np.degrees(home_posture()) + rng.uniform(-0.5, 0.5, 14)
    match rng.integers(5):
        case 0:
            line = str(rng.choice(_WORDS)).encode()
        case 1:
            line = encode(np.radians(good))[:-1]
        case 2:
            line = encode_rate(rng.uniform(-100, 100, 14))[:-1]
        case _:
            numbers = [f"{value:.4f}" for value in good]
            for _ in range(rng.integers(1, 4)):
                numbers[rng.integers(len(numbers))] = str(rng.choice(_NUMBERS))
            numbers = numbers[: int(rng.integers(10, 15))] if rng.random() < 0.3 else numbers
            begin = str(rng.choice(["", "", "RATE,", "RATE ,", "RATEX,", "RATE", "STOP,"]))
            line = (begin + ",".join(numbers)).encode()
    if rng.random() < 0.3:
        line = damaged(line or b"x", [each.encode() for each in (*_WORDS, *_NUMBERS)], rng)[:2000]
    if rng.random() < 0.2:
        at = int(rng.integers(len(line) + 1))
        line = line[:at] + _ODD[rng.integers(len(_ODD))] + line[at:]
    return line


def _link_input(rng: np.random.Generator) -> Input:
    """First who speaks: the client in control, or another one; then one line or several, with or without an end."""
    lines = [_line_of(rng) for _ in range(1 if rng.random() < 0.7 else int(rng.integers(2, 6)))]
    end = b"\r\n" if rng.random() < 0.3 else b"\n"
    data = end.join(lines) + (end if rng.random() < 0.9 else b"")
    return Input(_LINE, (b"C" if rng.random() < 0.6 else b"O") + data)


def is_good(line: bytes, longest: int) -> bool:
    """Whether docs/reference/link.md knows a line; written without the code that is tested."""
    try:
        text = line.decode("ascii").strip()
    except ValueError:
        return False
    if len(line) > longest:
        return False
    first, _, rest = text.partition(" ")
    if text in _GOOD_WORDS or first == "TOKEN":  # any token does for a link that asks for none
        return True
    if first == "VERSION":
        return rest.strip() in ("", "1")
    words = text.split(",")
    rate = words[0].strip() == "RATE"
    numbers = [word.strip(" \t\r\v\f") for word in (words[1:] if rate else words)]
    if len(numbers) != 14 or not all(_NUMBER.fullmatch(number) for number in numbers):
        return False
    values = np.array([float(number) for number in numbers])
    if rate:
        return bool(np.all(np.abs(values) <= _FULL_PERCENT))
    lower, upper = (np.degrees(np.concatenate([joint_limits(side)[i] for side in SIDES])) for i in (0, 1))
    if not np.isfinite(values).all():  # some joints turn without end
        return False
    return bool(np.all((values >= lower - _ROUNDING_DEG) & (values <= upper + _ROUNDING_DEG)))


@functools.cache
def _server() -> SetpointServer:
    wide = np.full(14, 1.0 / 3.0)
    server = SetpointServer(home_posture(), port=0)
    server.report(home_posture(), Signals(0.0, wide, wide, wide, wide, 0.0, np.zeros(2)))
    return server


def _talk_to_link(path: Path) -> str:
    """One conversation beside a client in control, or of the one in control; then the link must work as before."""
    data, server = path.read_bytes(), _server()
    own, message = data[:1] == b"C", data[1:]
    *lines, rest = message.split(b"\n")
    goods = [is_good(line, server.longest) for line in lines]
    bad = not all(goods) or len(rest) > server.longest
    client = SetpointClient(server.port)
    client.control()
    client.send(home_posture())
    assert server.command()[1], "a good set point does not open the valves"
    peer = client._socket if own else socket.create_connection(("127.0.0.1", server.port))
    peer.settimeout(_ANSWER_S)
    peer.sendall(message)
    before = goods.index(False) if False in goods else len(lines)
    answers, was_reset = _answers(peer, before + bad)
    open_now, reason = server.command()[1:]
    words = [line.strip() for line in lines]
    after_stop = words[len(words) - words[::-1].index(b"STOP") :] if b"STOP" in words else None
    if bad:
        assert not open_now, f"the valves are open after a bad message: {message[:80]!r}"
        if was_reset:  # it was ended while more was under way, and the answers were lost with it
            answers = [*[b""] * before, b"ERROR"]
        assert len(answers) == before + 1, (
            f"{message[:80]!r} is answered {len(answers)} times, not {before + 1}"
        )
        assert answers[-1].startswith(b"ERROR"), f"answered {answers[-1:]!r}"
    elif after_stop is not None and not any(b"," in word for word in after_stop):
        assert not open_now, "the valves are open after STOP"
    else:
        assert len(answers) == len(lines), f"{len(lines)} lines, {len(answers)} answers"
    peer.close()
    client.close()
    _closed(server)
    again = SetpointClient(server.port)
    again.control()
    again.send(home_posture())
    assert server.command()[1], f"a good set point no longer opens the valves ({reason})"
    again.stop()
    again.close()
    _closed(server)
    return "refused" if bad else "answered"


def _answers(peer: socket.socket, wanted: int) -> tuple[list[bytes], bool]:
    """Whole answers: so many, or fewer if they take long or the connection is ended; and whether it was reset."""
    received = b""
    while received.count(b"\n") < wanted:
        try:
            part = peer.recv(65536)
        except TimeoutError:
            break
        except ConnectionResetError:
            return received.split(b"\n")[:-1], True
        if not part:
            break
        received += part
    return received.split(b"\n")[:-1], False


def _closed(server: SetpointServer) -> None:
    """All connections are gone, and with them the valves are closed."""
    end = time.monotonic() + _ENDED_S
    while server._connections or server.command()[1]:
        assert time.monotonic() < end, "a connection that was ended keeps its seat, or the valves open"
        time.sleep(0.0005)


def _link_seeds() -> list[Input]:
    lines = [
        encode(home_posture()),
        encode_rate(np.zeros(14)),
        b"STATUS\r\n",
        b"SIGNALS\n",
        b"STOP\n",
        b"ALIVE\nVERSION 1\n",
    ]
    return [Input(_LINE, who + line) for who in (b"C", b"O") for line in lines]


def _answer_input(rng: np.random.Generator) -> Input:
    """What the controllers' end might answer, or send as signals."""
    if rng.random() < 0.5:
        return Input(_LINE, _line_of(rng) + b"\n")
    tree = changed_tree(
        json.loads(_signals().to_line()), ["time", "voltage", "grip", "x"], JSON_PIECES, rng, JSON_RAW
    )
    data = as_json(*tree).encode("utf-8", "surrogatepass") + b"\n"
    return Input(_LINE, damaged(data, [_signals().to_line()], rng) if rng.random() < 0.3 else data)


@functools.cache
def _signals() -> Signals:
    wide = np.full(14, 0.25)
    return Signals(0.5, wide, wide, wide, np.full(14, np.nan), 1e7, np.zeros(2))


def _read_answer(path: Path) -> str:
    line, became = path.read_bytes(), []
    for read in (decode_answer, signals_from_line):
        try:
            read(line)
            became.append("read")
        except InputError as error:
            assert str(error)
            became.append("refused")
    return " and ".join(became)


TARGETS = (
    Target("link", _link_input, _talk_to_link, _link_seeds),
    Target("answer", _answer_input, _read_answer, lambda: [Input(_LINE, _signals().to_line())]),
)
