"""When a recording was made: from its name, from its own clock, or from the file's date."""

import re
from dataclasses import dataclass
from datetime import datetime, timezone
from pathlib import Path

from hydrolek_drake.recordings import Recording

_NAMED = re.compile(
    r"(?<!\d)(\d{4})[-_.]?(\d{2})[-_.]?(\d{2})(?:[T _-]?(\d{2})[-_:.h]?(\d{2})(?:[-_:.m]?(\d{2}))?)?(?!\d)"
)
_EARLIEST, _LATEST = datetime(1990, 1, 1, tzinfo=timezone.utc), datetime(2100, 1, 1, tzinfo=timezone.utc)


@dataclass(frozen=True)
class Stamp:
    """A time and where it comes from.

    Attributes:
        seconds: since 1970 began [s], UTC.
        source: "name", "clock" (the recording's own time is that of a calendar) or "file" (date of its last change).
    """

    seconds: float
    source: str

    @property
    def iso(self) -> str:
        """As text, to the second."""
        return datetime.fromtimestamp(self.seconds, timezone.utc).strftime("%Y-%m-%d %H:%M:%S")


def stamp_of(path: Path, recording: Recording | None = None) -> Stamp:
    """When a recording was made: a date in its name first, then its own clock, then the file's date.

    Args:
        path: the file. A date in its name is YYYYMMDD or YYYY-MM-DD, with HHMM or HHMMSS behind it or none, as UTC.
        recording: as read; None for one that cannot be.
    """
    for found in _NAMED.finditer(path.stem):
        numbers = [int(each or 0) for each in found.groups()]
        try:
            named = datetime(*numbers, tzinfo=timezone.utc)  # type: ignore[arg-type,misc]
        except ValueError:
            continue
        if _EARLIEST <= named <= _LATEST:
            return Stamp(named.timestamp(), "name")
    if recording is not None and _EARLIEST.timestamp() <= float(recording.time[0]) <= _LATEST.timestamp():
        return Stamp(float(recording.time[0]), "clock")
    return Stamp(path.stat().st_mtime, "file")
