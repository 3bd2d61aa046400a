"""A text file that grows: the lines that are whole so far, and what comes."""

from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.live.lines import LineReader
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.settings import LONGEST_LINE, PIECE
from hydrolek_drake.watching.live.sources import Link

TEXT = (".csv", ".tsv", ".txt")


class FileSource:
    """Follows a file of comma, semicolon or tab separated text; one that is replaced or cut begins anew."""

    def __init__(self, path: Path, rig: Rig) -> None:
        """Begin with the first line.

        Raises:
            InputError: it is no text file by its name.
        """
        if path.suffix.lower() not in TEXT:
            raise InputError(
                f"--live {path}: only {', '.join(TEXT)}, .mcap and .db3 can be read while they are written"
            )
        self._path = path
        self._lines = LineReader(rig.columns, str(path))
        self._place, self._inode, self._rest = 0, -1, b""
        self._state, self._text = "waiting", ""

    def read(self) -> list[tuple[Samples, float | None]]:
        """Samples of the lines that are whole, a piece of the file at a time."""
        try:
            now = self._path.stat()
            if self._inode not in (-1, now.st_ino) or now.st_size < self._place:
                self._lines.restart()
                self._place, self._rest = 0, b""
            self._inode = now.st_ino
            if now.st_size == self._place:
                return []
            with self._path.open("rb") as stream:
                stream.seek(self._place)
                piece = stream.read(PIECE)
        except OSError as error:
            self._state, self._text = "lost", str(error.strerror or error)
            return []
        self._place += len(piece)
        self._state, self._text = "open", ""
        *lines, self._rest = (self._rest + piece).split(b"\n")
        if len(self._rest) > LONGEST_LINE:
            raise InputError(f"{self._path}: a line is longer than {LONGEST_LINE} bytes")
        text = [line.decode("utf-8", errors="replace") for line in lines]
        return [(samples, None) for samples in self._lines.read(text)]

    @property
    def exhausted(self) -> bool:
        """Whether all that is there has been read."""
        try:
            return self._path.stat().st_size <= self._place
        except OSError:
            return True

    def link(self) -> Link:
        """How it does."""
        text = self._text or (f"last bad line {self._lines.last_bad}" if self._lines.bad else "")
        return Link(str(self._path), self._state, text, self._lines.bad)

    def close(self) -> None:
        """Nothing is held open."""
