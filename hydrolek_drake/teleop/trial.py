"""Timed trials and how the operator felt about them: task timer and raw NASA-TLX ratings, one CSV line each.

NASA-TLX (Hart and Staveland 1988) asks for six ratings from 0 to 100. The raw form (Hart 2006) takes their mean and
leaves out the weighting by fifteen comparisons.
"""

import csv
import datetime
import errno
import io
import os
import threading
import time
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError
from hydrolek_drake.files import disarmed

SCALES = ("mental", "physical", "temporal", "performance", "effort", "frustration")
CONTROLS = ("assisted", "joystick", "sliders")
COLUMNS = ("finished", "operator", "control", "task_s", *SCALES, "raw_tlx", "note")

_FULL = 100
_LONGEST_TEXT = 200  # characters


class TrialLog:
    """Task timer, and a file `trials.csv` that trials are appended to.

    Args:
        folder: Where; made if it is missing. None for the timer alone.

    Raises:
        InputError: The folder cannot be made, or its trials.csv is another table.
    """

    def __init__(self, folder: Path | None) -> None:
        self._lock = threading.Lock()
        self._began: float | None = None
        self._took: float | None = None
        self._saved = 0
        self._path = None if folder is None else folder / "trials.csv"
        if folder is not None and self._path is not None:
            try:
                folder.mkdir(parents=True, exist_ok=True)
                text = self._path.read_text(encoding="utf-8") if self._path.exists() else ""
            except (OSError, UnicodeDecodeError) as error:
                raise InputError(f"teleop: --out {folder}: {error}; choose another folder") from None
            rows = list(csv.reader(io.StringIO(text)))
            if rows and tuple(rows[0]) != COLUMNS:
                raise InputError(
                    f"{self._path}: its first line is not {','.join(COLUMNS)}; choose another --out"
                )
            self._saved = max(0, len(rows) - 1)

    def timer(self, action: str) -> None:
        """Start, stop or reset the timer.

        Raises:
            InputError: Unknown action.
        """
        with self._lock:
            if action == "start":
                self._began, self._took = time.monotonic(), None
            elif action == "stop":
                if self._began is not None:
                    self._took, self._began = time.monotonic() - self._began, None
            elif action == "reset":
                self._began = self._took = None
            else:
                raise InputError(f"timer: '{action[:40]}' is unknown; choose start, stop, reset")

    def state(self) -> dict[str, Any]:
        """What the page shows."""
        with self._lock:
            return {
                "running": self._began is not None,
                "seconds": self._seconds(),
                "saved": self._saved,
                "file": None if self._path is None else str(self._path),
            }

    def save(self, ratings: dict[str, Any]) -> None:
        """Append a trial as one whole line and reset the timer.

        Args:
            ratings: `operator`, `control`, `note`, and the six scales from 0 to 100.

        Raises:
            InputError: Something is missing or out of range, the timer has not been used, or the file cannot be
                written.
        """
        row = _checked(ratings)
        with self._lock:
            if self._path is None:
                raise InputError("ratings are not kept; start with --out FOLDER")
            if self._began is not None:
                raise InputError("the timer is running; stop it before you save")
            if self._took is None:
                raise InputError("there is no time to save; start and stop the timer")
            row["finished"] = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
            row["task_s"] = f"{self._took:.1f}"
            try:
                _append(self._path, [row[name] for name in COLUMNS])
            except OSError as error:
                raise InputError(f"{self._path} cannot be written: {error.strerror}") from None
            self._saved += 1
            self._took = None

    def _seconds(self) -> float | None:
        seconds = self._took if self._began is None else time.monotonic() - self._began
        return None if seconds is None else round(seconds, 1)


def _checked(ratings: dict[str, Any]) -> dict[str, Any]:
    unknown = set(ratings) - {"operator", "control", "note", *SCALES}
    if unknown:
        raise InputError(f"ratings: '{min(unknown)[:40]}' is unknown")
    row: dict[str, Any] = {}
    for name in ("operator", "note"):
        text = ratings.get(name, "")
        if not isinstance(text, str) or len(text) > _LONGEST_TEXT:
            raise InputError(f"ratings: {name} must be text of at most {_LONGEST_TEXT} characters")
        row[name] = " ".join(text.split())
    if not row["operator"]:
        raise InputError("ratings: who was the operator? A name or number is needed")
    if ratings.get("control") not in CONTROLS:
        raise InputError(f"ratings: control must be one of {', '.join(CONTROLS)}")
    row["control"] = ratings["control"]
    for name in SCALES:
        value = ratings.get(name)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0 <= value <= _FULL:
            raise InputError(f"ratings: {name} must be a number from 0 to {_FULL}")
        row[name] = f"{value:g}"
    row["raw_tlx"] = f"{sum(float(row[name]) for name in SCALES) / len(SCALES):.2f}"
    return row


def _append(path: Path, row: list[Any]) -> None:
    """Add one line by a single write to the end of the file; the first line says what the columns are."""
    handle = os.open(path, os.O_RDWR | os.O_APPEND | os.O_CREAT, 0o644)
    try:
        size = os.fstat(handle).st_size
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        if size == 0:
            writer.writerow(COLUMNS)
        elif os.pread(handle, 1, size - 1) != b"\n":
            text.write("\n")  # someone's editor left the last line open
        writer.writerow([disarmed(str(cell)) for cell in row])
        data = text.getvalue().encode("utf-8")
        written = os.write(handle, data)
        if written != len(data):
            os.ftruncate(handle, size)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        os.fsync(handle)
    finally:
        os.close(handle)
