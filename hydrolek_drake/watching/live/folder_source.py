"""A folder in which recordings appear and grow: each is followed until a later one is there."""

import time
from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.live.bag_source import BagSource, is_bag
from hydrolek_drake.watching.live.file_source import TEXT, FileSource
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.settings import QUIET_S
from hydrolek_drake.watching.live.sources import Link


class FolderSource:
    """Follows the recordings of a folder in the order of their names, those that are there first.

    Text and bags are read while they grow; of other formats a file counts once it has stopped growing. One that cannot
    be read is passed over and counted.
    """

    def __init__(self, folder: Path, rig: Rig) -> None:
        """Look into it from now on."""
        self._folder, self._rig = folder, rig
        self._last = ""
        self._now: FileSource | BagSource | _Whole | None = None
        self._bad, self._text = 0, ""

    def read(self) -> list[tuple[Samples, float | None]]:
        """What is new in the recording at hand; once it has ended and a later one is there, of that."""
        if self._now is None or (self._now.exhausted and self._later()):
            self._next()
        if self._now is None:
            return []
        try:
            return self._now.read()
        except InputError as error:
            self._bad, self._text = self._bad + 1, str(error)
            self._leave()
            return []

    def link(self) -> Link:
        """How it does."""
        if self._now is None:
            return Link(str(self._folder), "waiting", self._text or "no recording yet", self._bad)
        inner = self._now.link()
        return Link(inner.name, inner.state, inner.text or self._text, self._bad + inner.bad)

    def close(self) -> None:
        """End the recording at hand."""
        self._leave()

    def _leave(self) -> None:
        if self._now is not None:
            self._now.close()
        self._now = None

    def _later(self) -> list[Path]:
        """Recordings after the one at hand."""
        try:
            inside = [p for p in self._folder.iterdir() if not p.name.startswith(".") and p.name > self._last]
        except OSError as error:
            self._text = f"{self._folder}: {error.strerror or error}"
            return []
        return sorted(p for p in inside if p.is_file() or is_bag(p))

    def _next(self) -> None:
        self._leave()
        for path in self._later():
            self._last = path.name
            try:
                if is_bag(path):
                    self._now = BagSource(path, self._rig)
                elif path.suffix.lower() in TEXT:
                    self._now = FileSource(path, self._rig)
                else:
                    self._now = _Whole(path, self._rig)
                return
            except InputError as error:
                self._bad, self._text = self._bad + 1, str(error)


class _Whole:
    """A file that is read once it has stopped growing."""

    def __init__(self, path: Path, rig: Rig) -> None:
        self._path, self._rig = path, rig
        self._size, self._since = -1, time.monotonic()
        self.exhausted = False

    def read(self) -> list[tuple[Samples, float | None]]:
        if self.exhausted:
            return []
        try:
            size = self._path.stat().st_size
        except OSError:
            size = -1
        if size != self._size:
            self._size, self._since = size, time.monotonic()
            return []
        if time.monotonic() - self._since < QUIET_S:
            return []
        self.exhausted = True
        recording = read_recording(self._path, self._rig.columns, dead_time=self._rig.dead_time)
        return [(Samples.of(recording), None)]

    def link(self) -> Link:
        return Link(str(self._path), "open" if self.exhausted else "waiting", "read when it is complete")

    def close(self) -> None:
        self.exhausted = True
