"""Where samples come from: what all sources have in common, and which one an argument of `--live` names."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.live.samples import Samples

TCP = "tcp://"


@dataclass(frozen=True)
class Link:
    """How a source does.

    Attributes:
        name: of the source.
        state: "waiting" (nothing has come yet), "open" or "lost".
        text: more about it.
        bad: lines or files that could not be read.
        dropped: samples that were dropped since the observer is too slow.
        timely: whether samples come when they are made, so that the time of their arrival tells gaps from jumps.
    """

    name: str
    state: str
    text: str = ""
    bad: int = 0
    dropped: int = 0
    timely: bool = False


class Source(Protocol):
    """Something that brings samples."""

    def read(self) -> list[tuple[Samples, float | None]]:
        """What is new since the last call, each with when it came [s]; None where it came when nobody knows.

        Raises:
            InputError: what comes is no stream of samples, and will not become one.
        """

    def link(self) -> Link:
        """How it does."""

    def close(self) -> None:
        """End it."""


def source_of(
    text: str, rig: Rig, token: str | None = None, accepts: Callable[[Samples], None] = lambda samples: None
) -> Source:
    """The source that an argument names: `tcp://HOST:PORT` to listen at, a file, or a folder.

    Args:
        text: the argument.
        rig: with the names of columns.
        token: that a sender over a network must show.
        accepts: raises `InputError` for samples whose signals will not do, so that a sender is told so at once.

    Raises:
        InputError: it names nothing that can be followed.
    """
    from hydrolek_drake.watching.live.bag_source import BagSource, is_bag
    from hydrolek_drake.watching.live.file_source import FileSource
    from hydrolek_drake.watching.live.folder_source import FolderSource
    from hydrolek_drake.watching.live.tcp_source import TcpSource

    if "://" in text:
        if not text.startswith(TCP):
            raise InputError(f"--live {text}: write {TCP}127.0.0.1:PORT, a file or a folder")
        host, port = _address(text)
        return TcpSource(host, port, rig, token, accepts)
    path = Path(text)
    if not path.exists():
        raise InputError(f"--live {text}: no such file or folder")
    if is_bag(path):
        return BagSource(path, rig)
    if path.is_dir():
        return FolderSource(path, rig)
    return FileSource(path, rig)


def _address(text: str) -> tuple[str, int]:
    host, colon, port = text.removeprefix(TCP).rpartition(":")
    if not colon or not port.isascii() or not port.isdigit() or not 0 <= int(port) <= 65535:
        raise InputError(f"--live {text}: write {TCP}HOST:PORT, such as {TCP}127.0.0.1:6350")
    return host.strip("[]") or "127.0.0.1", int(port)
