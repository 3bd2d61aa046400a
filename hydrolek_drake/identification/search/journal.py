"""What a search has evaluated, on disk: an interrupted search goes on by repeating its steps from there.

A search with the same seed asks for the same points in the same order. So nothing of its inner state is
kept: on resuming it starts anew, and is answered from the journal as far as that reaches. The result is that
of an unbroken run, for every method.

Each row carries a checksum: what a crash or a loss of power has torn at the end is evaluated again.
"""

import json
import os
import zlib
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import to_disk, write_whole

_FORMAT = 2


class Journal:
    """A file: one line of JSON that says which search it belongs to, then rows of float64, the last their checksum."""

    def __init__(self, path: Path, belongs_to: dict[str, Any], dimension: int, size: int) -> None:
        """Open, or begin, the journal.

        Args:
            path: the file.
            belongs_to: what makes the search what it is: method, seed, settings, data.
            dimension: parameters of a point.
            size: values of an evaluation.

        Raises:
            InputError: the file belongs to another search, is empty, cut off within its first line, or no journal.
        """
        self.path = path
        self._dimension = dimension
        self._width = dimension + size
        self._used = 0
        head = {"format": _FORMAT, **belongs_to, "dimension": dimension, "size": size}
        line = json.dumps(head, sort_keys=True).encode() + b"\n"
        self.rows = np.empty((0, self._width))
        if path.exists():
            self._read(line)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, line)
        self._file = path.open("ab")

    def _read(self, line: bytes) -> None:
        raw = self.path.read_bytes()
        if not raw.strip(b"\0"):
            self._refuse("is empty, as a full disk leaves it")
        found, newline, body = raw.partition(b"\n")
        if found + b"\n" != line or not newline:
            self._refuse(_difference(found, line, whole=bool(newline)))
        length = 8 * (self._width + 1)
        rows = np.frombuffer(body[: len(body) // length * length]).reshape(-1, self._width + 1)
        sound = [checksum(row[:-1]) == row[-1] for row in rows]
        kept = sound.index(False) if False in sound else len(sound)
        self.rows = rows[:kept, :-1]
        if len(line) + kept * length < len(raw):
            os.truncate(self.path, len(line) + kept * length)

    def replayed(self, units: np.ndarray) -> list[np.ndarray]:
        """Values of the leading points that the journal knows.

        Raises:
            InputError: it knows others, so it is not of this search.
        """
        rows = self.rows[self._used : self._used + len(units)]
        if len(rows) and not np.array_equal(rows[:, : self._dimension], units[: len(rows)]):
            self._refuse("was written by another version of the search")
        self._used += len(rows)
        return list(rows[:, self._dimension :])

    def append(self, units: np.ndarray, scores: list[np.ndarray]) -> None:
        """Write new evaluations; they are on disk when this returns."""
        rows = np.hstack([units, np.array(scores)]).astype(np.float64)
        self._file.write(np.hstack([rows, [[checksum(row)] for row in rows]]).tobytes())
        self._file.flush()
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file; it stays."""
        self._file.close()
        to_disk(self.path.parent)

    def _refuse(self, what: str) -> NoReturn:
        raise InputError(f"{self.path}: the checkpoint {what}; remove it to start afresh")


def checksum(row: np.ndarray) -> float:
    """CRC-32 of a row's bytes."""
    return float(zlib.crc32(np.ascontiguousarray(row, dtype=np.float64).tobytes()))


def _difference(found: bytes, line: bytes, *, whole: bool) -> str:
    """What is wrong with a first line that is not the one that it should be."""
    if not whole and line.startswith(found):
        return "is cut off within its first line"
    try:
        theirs, ours = json.loads(found), json.loads(line)
        other = sorted(key for key in {*theirs, *ours} if theirs.get(key) != ours.get(key))
    except (ValueError, AttributeError, RecursionError):
        return "is damaged, or no checkpoint at all"
    if "format" in other:
        return "was written by another version of the search"
    return f"belongs to another search (other {', '.join(other)[:100] or 'spelling'})"
