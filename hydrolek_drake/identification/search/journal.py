"""What a search has evaluated, on disk: an interrupted search goes on by repeating its steps from there.

A search with the same seed asks for the same points in the same order. So nothing of its inner state is
kept: on resuming it starts anew, and is answered from the journal as far as that reaches. The result is that
of an unbroken run, for every method.
"""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError


class Journal:
    """A file: one line of JSON that says which search it belongs to, then rows of float64."""

    def __init__(self, path: Path, belongs_to: dict[str, Any], dimension: int, size: int) -> None:
        """Open, or begin, the journal.

        Args:
            path: the file.
            belongs_to: what makes the search what it is: method, seed, settings, data.
            dimension: parameters of a point.
            size: values of an evaluation.

        Raises:
            InputError: the file belongs to another search.
        """
        self.path = path
        self._dimension = dimension
        self._width = dimension + size
        self._used = 0
        head = json.dumps({**belongs_to, "dimension": dimension, "size": size}, sort_keys=True) + "\n"
        self.rows = np.empty((0, self._width))
        if path.exists():
            raw = path.read_bytes()
            found, newline, body = raw.partition(b"\n")
            if found.decode("utf-8", "replace") + "\n" != head or not newline:
                raise InputError(
                    f"{path}: the checkpoint belongs to another search (other method, seed, settings or "
                    "recordings); remove it to start afresh"
                )
            whole = len(body) // (8 * self._width)  # a row torn by a crash is evaluated again
            self.rows = np.frombuffer(body[: whole * 8 * self._width]).reshape(whole, self._width)
            kept = len(found) + 1 + whole * 8 * self._width
            if kept < len(raw):
                os.truncate(path, kept)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(head.encode())
        self._file = path.open("ab")

    def replayed(self, units: np.ndarray) -> list[np.ndarray]:
        """Values of the leading points that the journal knows.

        Raises:
            InputError: it knows others, so it is not of this search.
        """
        rows = self.rows[self._used : self._used + len(units)]
        if len(rows) and not np.array_equal(rows[:, : self._dimension], units[: len(rows)]):
            raise InputError(
                f"{self.path}: the checkpoint was written by another version of the search; remove it"
            )
        self._used += len(rows)
        return list(rows[:, self._dimension :])

    def append(self, units: np.ndarray, scores: list[np.ndarray]) -> None:
        """Write new evaluations; they are on disk when this returns."""
        self._file.write(np.hstack([units, np.array(scores)]).astype(np.float64).tobytes())
        self._file.flush()

    def close(self) -> None:
        """Close the file; it stays."""
        self._file.close()
