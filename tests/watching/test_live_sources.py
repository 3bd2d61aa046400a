"""Where samples come from: files and folders that grow, bags that are being written, a stream over TCP."""

import socket
import time

import numpy as np
import pytest
from bags import FLOAT64, number, write_bag

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.live.bag_source import McapPieces, SqlitePieces
from hydrolek_drake.watching.live.choosing import source_of
from hydrolek_drake.watching.live.file_source import FileSource
from hydrolek_drake.watching.live.folder_source import FolderSource
from hydrolek_drake.watching.live.lines import LineReader
from hydrolek_drake.watching.live.samples import by_joint
from hydrolek_drake.watching.live.settings import BAD_IN_A_ROW
from hydrolek_drake.watching.live.tcp_source import TcpSource

HEAD = "time_s,joint.command_V,joint.angle_deg\n"
PATIENCE_S = 20.0


@pytest.fixture(scope="module")
def rig():
    return load_rig("joint_bench")


def _read(source):
    """All that is there now: times and whether a recording begins."""
    found = source.read()
    return [t for samples, _ in found for t in samples.time.tolist()], [s.begins for s, _ in found]


def test_lines_of_a_recording_become_samples_in_si(rig):
    reader = LineReader({"hand": "joint.command_V", "spare.angle_deg": "ignore"}, "stream")
    [samples] = reader.read(
        ["# made by hand", "time_ms;hand;joint.angle_deg;spare.angle_deg", "10;1,5;90;1", "", "20;;180;2"]
    )
    assert samples.time.tolist() == [0.01, 0.02] and samples.begins
    values = by_joint(rig, ("joint",), samples)
    assert values[:, 0, 1] == pytest.approx([np.pi / 2, np.pi])
    assert values[0, 0, 0] == 1.5 and np.isnan(values[1, 0, 0]) and np.isnan(values[:, 0, 2:]).all()


def test_bad_lines_are_counted_and_bad_names_refused():
    reader = LineReader({}, "stream")
    [samples] = reader.read([HEAD, "0,1,2", "0.01,1", "0.02,x,3", "0.03,1_0,3", "0.04,1,2"])
    assert samples.time.tolist() == [0.0, 0.04] and reader.bad == 3 and reader.bad_in_a_row == 0
    for head in (
        "time_s,joint.angle_furlong",
        "time_s,other",
        "a,b",
        "time_s,joint.angle_deg,joint.angle_rad",
    ):
        with pytest.raises(InputError):
            LineReader({}, "stream").read([head])
    with pytest.raises(InputError, match="names"):
        LineReader({}, "stream").read(["1,2,3"])


def test_a_file_is_followed_line_by_whole_line_and_from_the_start_where_it_is_replaced(rig, tmp_path):
    path = tmp_path / "run.csv"
    path.write_text(HEAD + "0,1,2\n0.01,1,2\n0.0")
    source = FileSource(path, rig)
    assert _read(source) == ([0.0, 0.01], [True]) and _read(source) == ([], [])
    with path.open("a") as stream:
        stream.write("2,1,2\n")
    assert _read(source) == ([0.02], [False])
    path.write_text(HEAD + "5,1,2\n")
    assert _read(source) == ([5.0], [True])
    path.unlink()
    assert _read(source) == ([], []) and source.link().state == "lost"


def test_a_folder_is_followed_recording_after_recording_and_a_broken_one_passed_over(rig, tmp_path):
    (tmp_path / "a.csv").write_text(HEAD + "0,1,2\n")
    source = source_of(str(tmp_path), rig)
    assert isinstance(source, FolderSource)
    assert _read(source) == ([0.0], [True])
    (tmp_path / "b.csv").write_text("nothing,here\n1,2\n")
    (tmp_path / "c.csv").write_text(HEAD + "0.5,1,2\n")
    times = [_read(source)[0] for _ in range(3)]
    assert [t for each in times for t in each] == [0.5]
    assert source.link().bad == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("tcp://127.0.0.1", "HOST:PORT"),
        ("tcp://127.0.0.1:70000", "HOST:PORT"),
        ("udp://127.0.0.1:7000", "tcp://"),
        ("absent.csv", "no such file"),
    ],
)
def test_what_cannot_be_followed_is_refused(rig, text, said):
    with pytest.raises(InputError, match=said):
        source_of(text, rig)


def _messages():
    # two topics, 100 a second each, for four seconds
    for i in range(400):
        at = 1_000_000_000 + 10_000_000 * i
        yield "/joint/command_V", FLOAT64, at, number(1.0 + i)
        yield "/joint/angle_rad", FLOAT64, at + 1000, number(0.001 * i)


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_what_is_complete_of_a_bag_is_a_bag(storage, tmp_path):
    whole = write_bag(tmp_path / "bag", list(_messages()), storage=storage)
    file = next(p for p in whole.iterdir() if p.suffix in (".mcap", ".db3"))
    growing = tmp_path / f"growing{file.suffix}"
    piece = tmp_path / f"piece{file.suffix}"
    content = file.read_bytes()
    if storage == "mcap":  # a recorder that was killed: half a record at the end, no footer
        growing.write_bytes(content[: len(content) // 20])
        pieces = McapPieces(growing)
        pieces.write(piece)
        growing.write_bytes(content[:-100])
    else:
        growing.write_bytes(content)
        pieces = SqlitePieces(growing)
    assert pieces.write(piece)
    recording = read_recording(piece)
    command = recording.signal("joint.command")
    assert recording.time.size > 300 and command[0] < 100.0 and command[-1] > 390.0
    assert not pieces.write(tmp_path / f"next{file.suffix}")  # nothing is new


def test_what_is_no_bag_is_refused(tmp_path):
    for name, pieces in (("a.mcap", McapPieces), ("a.db3", SqlitePieces)):
        (tmp_path / name).write_bytes(b"nothing that a recorder has written" * 100)
        with pytest.raises(InputError):
            pieces(tmp_path / name).write(tmp_path / f"piece_{name}")


class _Sender:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)

    def say(self, text):
        self.socket.sendall(text.encode())

    def hear(self):
        heard = b""
        while not heard.endswith(b"\n"):
            more = self.socket.recv(1000)
            if not more:
                break
            heard += more
        return heard.decode().strip()


def _waited(source, count):
    found, until = [], time.monotonic() + PATIENCE_S
    while len(found) < count and time.monotonic() < until:
        found += _read(source)[0]
        time.sleep(0.01)
    return found


def _gone(source):
    until = time.monotonic() + PATIENCE_S
    while source.link().state == "open" and time.monotonic() < until:
        time.sleep(0.01)
    return source.link().state == "lost"


def test_a_sender_is_heard_and_the_next_one_once_it_has_gone(rig):
    source = TcpSource("127.0.0.1", 0, rig)
    try:
        first = _Sender(source.port)
        first.say(HEAD)
        assert first.hear() == "OK"
        first.say("0,1,2\n0.01,1,2\n0.02,")
        assert _waited(source, 2) == [0.0, 0.01]
        second = _Sender(source.port)
        assert second.hear().startswith("BUSY")
        first.say("1,2\n")
        assert _waited(source, 1) == [0.02]
        first.socket.close()
        assert _gone(source)
        third = _Sender(source.port)
        third.say(HEAD + "7,1,2\n")
        assert third.hear() == "OK" and _waited(source, 1) == [7.0]
    finally:
        source.close()


def test_a_sender_of_nonsense_is_told_so_and_cut_off(rig):
    def accepts(samples):
        by_joint(rig, ("joint",), samples)

    source = TcpSource("127.0.0.1", 0, rig, accepts=accepts)
    try:
        for said in (
            "time_s,other\n",
            HEAD + "x,y,1\n" * BAD_IN_A_ROW,
            "time_s,joint.command_V\n",
            "7" * 70000,
        ):
            sender = _Sender(source.port)
            sender.say(said)
            heard = sender.hear().removeprefix("OK").strip() or sender.hear()
            assert heard.startswith("ERROR")
            assert _gone(source)
    finally:
        source.close()


def test_a_token_is_asked_for_where_there_is_one(rig):
    source = TcpSource("127.0.0.1", 0, rig, token="a token of many letters")
    try:
        stranger = _Sender(source.port)
        stranger.say(HEAD + "0,1,2\n")
        assert stranger.hear().startswith("ERROR") and _gone(source)
        friend = _Sender(source.port)
        friend.say("TOKEN a token of many letters\n")
        assert friend.hear() == "OK"
        friend.say(HEAD + "0,1,2\n")
        assert friend.hear() == "OK" and _waited(source, 1) == [0.0]
    finally:
        source.close()
