"""Which source an argument of `--live` names."""

from collections.abc import Callable
from pathlib import Path

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig
from hydrolek_drake.watching.live.bag_source import BagSource, is_bag
from hydrolek_drake.watching.live.file_source import FileSource
from hydrolek_drake.watching.live.folder_source import FolderSource
from hydrolek_drake.watching.live.samples import Samples
from hydrolek_drake.watching.live.sources import Source
from hydrolek_drake.watching.live.tcp_source import TcpSource

TCP = "tcp://"


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
