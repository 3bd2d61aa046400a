"""ROS 2 bags that are being written: what is complete so far, as a small bag of its own.

Recorders write MCAP as records behind one another, most of them chunks of messages, and sqlite3 as rows. Neither file
is whole before the recorder ends: an MCAP file lacks its footer, and readers refuse it. So the records that are
complete, or the rows that are new, are copied into a bag beside it, with the schemas and channels that came before;
that is whole, and is read as any recording, in a process of its own. Pieces overlap, since signals of several topics
are put on one clock within each.
"""

import sqlite3
import struct
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.settings import BAG_POLL_S
from hydrolek_drake.watching.live.sources import Link

ENDINGS = (".mcap", ".db3")
_MAGIC = b"\x89MCAP0\r\n"
_DATA_END, _FOOTER, _CHUNK = 0x0F, 0x02, 0x06
_OVERLAP_NS = 1_000_000_000


def is_bag(path: Path) -> bool:
    """Whether this is a bag: a file of one, or a folder that holds one."""
    if path.is_dir():
        return (path / "metadata.yaml").exists() or bool(_files(path))
    return path.suffix.lower() in ENDINGS


def _files(folder: Path) -> list[Path]:
    """Files of a bag's folder in the order in which they were begun."""
    found = [p for p in folder.iterdir() if p.suffix.lower() in ENDINGS]
    return sorted(found, key=lambda p: (len(p.name), p.name))  # _9 is before _10


class BagSource:
    """Follows a bag, in a thread of its own."""

    def __init__(self, path: Path, rig: Rig) -> None:
        """Begin with its first message."""
        self._path, self._rig = path, rig
        self._done: list[Path] = []
        self._pieces: Callable[[Path], bool] | None = None
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="bag")
        self._asked: Future[Samples | None] | None = None
        self._next = 0.0
        self._last = -np.inf
        self._begins = True
        self._state, self._text, self._bad = "waiting", "", 0
        self.exhausted = False

    def read(self) -> list[tuple[Samples, float | None]]:
        """What a piece has brought that is ready by now."""
        if self._asked is None:
            if time.monotonic() >= self._next:
                self._asked = self._worker.submit(self._piece)
            return []
        if not self._asked.done():
            return []
        asked, self._asked = self._asked, None
        self._next = time.monotonic() + BAG_POLL_S
        try:
            samples = asked.result()
        except InputError as error:
            self._bad, self._text = self._bad + 1, str(error)
            return []
        self.exhausted = samples is None
        if samples is None or not samples.time.size:
            return []
        self._state, self._text = "open", ""
        self._last = float(samples.time[-1])
        return [(samples, None)]

    def link(self) -> Link:
        """How it does."""
        return Link(str(self._path), self._state, self._text, self._bad)

    def close(self) -> None:
        """End the thread."""
        self._worker.shutdown(wait=True, cancel_futures=True)

    def _piece(self) -> Samples | None:
        """Samples that are new; None for none."""
        files = _files(self._path) if self._path.is_dir() else [self._path]
        files = [p for p in files if p not in self._done]
        if not files:
            return None
        with tempfile.TemporaryDirectory() as scratch:
            file = files[0]
            if self._pieces is None:
                self._pieces = (McapPieces if file.suffix.lower() == ".mcap" else SqlitePieces)(file).write
            piece = Path(scratch) / f"piece{file.suffix.lower()}"
            if not self._pieces(piece):
                if len(files) > 1:  # the recorder has gone on to the next file
                    self._done.append(file)
                    self._pieces = None
                return None
            recording = read_recording(piece, self._rig.columns, dead_time=self._rig.dead_time)
        return self._new(recording)

    def _new(self, recording: Recording) -> Samples:
        keep = recording.time > self._last
        signals = {key: values[keep] for key, values in recording.signals.items()}
        begins, self._begins = self._begins, False
        return Samples(recording.time[keep], signals, recording.units, begins, str(self._path))


class McapPieces:
    """Complete records of an MCAP file that grows (mcap.dev/spec): opcode, length, content, one behind the other."""

    def __init__(self, path: Path) -> None:
        """Begin with its first record."""
        self._path = path
        self._place = len(_MAGIC)
        self._head = b""
        self._before = b""

    def write(self, piece: Path) -> bool:
        """Write the records since the last piece, with those that name channels; whether there are any.

        Raises:
            InputError: it is no MCAP file.
        """
        try:
            with self._path.open("rb") as stream:
                magic = stream.read(len(_MAGIC))
                stream.seek(self._place)
                content = stream.read(_MOST)
        except OSError as error:
            raise InputError(f"{self._path}: {error.strerror or error}") from None
        if magic != _MAGIC[: len(magic)]:
            raise InputError(f"{self._path} is no MCAP file")
        records = _complete(content)
        self._place += sum(map(len, records))
        data = [r for r in records if r[0] in _DATA]
        naming = [r for r in records if r[0] in _NAMING]
        if not self._head and data:
            # a recorder that writes chunks names channels within the first ones that use them
            self._head = b"".join([*naming, data[0]] if data[0][0] == _CHUNK else naming)
            fresh = b"".join(data[1:] if data[0][0] == _CHUNK else data)
        else:
            self._head += b"".join(naming)
            fresh = b"".join(data)
        if not data:
            return False
        end = struct.pack("<BQI", _DATA_END, 4, 0) + struct.pack("<BQQQI", _FOOTER, 20, 0, 0, 0)
        piece.write_bytes(_MAGIC + self._head + self._before + fresh + end + _MAGIC)
        if data:
            self._before = data[-1] if data[-1][0] == _CHUNK else b"".join(data[-_MESSAGES:])
        return True


_NAMING = (0x01, 0x03, 0x04)  # header, schema, channel
_DATA = (0x05, _CHUNK)  # message, chunk
_MOST = 1 << 26
"""Bytes that are looked at for one piece; a recorder's chunks have less than a megabyte."""

_MESSAGES = 1000
"""Messages outside chunks that a piece has in common with the next: a second of ten topics of 100 Hz."""


def _complete(content: bytes) -> list[bytes]:
    """Records that are there to their last byte."""
    found, place = [], 0
    while place + 9 <= len(content):
        end = place + 9 + struct.unpack_from("<Q", content, place + 1)[0]
        if end > len(content):
            break
        found.append(content[place:end])
        place = end
    return found


class SqlitePieces:
    """New rows of a sqlite3 bag that grows; its recorder may write meanwhile."""

    def __init__(self, path: Path) -> None:
        """Begin with its first row."""
        self._path, self._place = path, -1

    def write(self, piece: Path) -> bool:
        """Write the messages since the last piece, and a second before them; whether there are any.

        Raises:
            InputError: it is no sqlite3 bag.
        """
        try:
            source = sqlite3.connect(f"file:{self._path}?mode=ro", uri=True)
            target = sqlite3.connect(piece)
            try:
                newest = source.execute("SELECT max(id) FROM messages").fetchone()[0]
                if newest is None or newest <= self._place:
                    return False
                since = source.execute(
                    "SELECT min(timestamp) FROM messages WHERE id > ?", (self._place,)
                ).fetchone()[0]
                for name, create in source.execute(
                    "SELECT name, sql FROM sqlite_master WHERE type = 'table' AND name NOT LIKE 'sqlite_%'"
                ).fetchall():
                    target.execute(create)
                    where = " WHERE timestamp >= ?" if name == "messages" else ""
                    given = (since - _OVERLAP_NS,) if where else ()
                    rows = source.execute(f'SELECT * FROM "{name}"{where}', given)
                    marks = ", ".join("?" * len(rows.description))
                    target.executemany(f'INSERT INTO "{name}" VALUES ({marks})', rows)
                target.commit()
            finally:
                source.close()
                target.close()
        except sqlite3.Error as error:
            raise InputError(f"{self._path}: {error}") from None
        self._place = newest
        return True
