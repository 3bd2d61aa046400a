"""Writing a file so that it is either complete or not there."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hydrolek_drake.errors import InputError


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write under a temporary name, then rename; an older file of that name is replaced only then.

    Raises:
        OSError: the folder cannot be written to.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_bytes(data.encode() if isinstance(data, str) else data)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
    return path


def is_file(path: Path) -> bool:
    """Whether there is a file of that name, which may be a name that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


@contextmanager
def results_folder(folder: Path) -> Iterator[None]:
    """Make a command's `--out` folder and write into it.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        yield
    except OSError as error:
        raise InputError(f"--out {folder}: cannot write there: {error.strerror or error}") from None
