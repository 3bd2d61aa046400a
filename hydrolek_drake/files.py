"""Files that are either complete or not there, and those kept from an earlier run read back."""

import contextlib
import itertools
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from hydrolek_drake.errors import InputError, meant

_FORMULAS = ("=", "+", "-", "@", "\uff1d", "\uff0b", "\uff0d", "\uff20")  # the wide ones too
_NUMBER = itertools.count()


@contextmanager
def being_written(path: Path) -> Iterator[Path]:
    """A temporary name in the same folder to write to; what stands there takes the name of `path` when all is well.

    Once this ends, the content is on disk: after a loss of power too there is the new file or the older one, whole.

    Raises:
        OSError: the folder cannot be written to.
    """
    part = path.with_name(f".{path.name[:80]}.{os.getpid()}.{next(_NUMBER)}.part")
    try:
        yield part
        with part.open("rb+") as stream:
            os.fsync(stream.fileno())
        part.replace(path)
        to_disk(path.parent)
    finally:
        part.unlink(missing_ok=True)


def write_whole(path: Path, data: bytes | str) -> Path:
    """Write a file, see `being_written`; an older file of that name is replaced only when this one is complete.

    Raises:
        OSError: the folder cannot be written to.
    """
    with being_written(path) as part:
        part.write_bytes(data.encode() if isinstance(data, str) else data)
    return path


def write_results(folder: Path, contents: Mapping[str, bytes | str]) -> list[Path]:
    """Write name -> content into a command's `--out` folder, each file when it is complete.

    Returns:
        Their paths.

    Raises:
        InputError: the folder cannot be made or written to.
    """
    with results_folder(folder):
        return [write_whole(folder / name, content) for name, content in contents.items()]


def write_out(path: Path, data: bytes | str) -> Path:
    """Write the file that a command's `--out` names, and make its folder.

    Raises:
        InputError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return write_whole(path, data)
    except (OSError, ValueError) as error:
        raise InputError(f"--out {path}: cannot write there: {_reason(error)}") from None


def read_kept(path: Path, what: str, keys: tuple[str, ...] = ()) -> Any:
    """Content of a JSON file that an earlier run left to go on from.

    Args:
        path: the file.
        what: it holds, for errors.
        keys: of the mapping that it must be, if any are given.

    Raises:
        InputError: it is empty, cut off, no JSON, or without these keys.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: {what} cannot be read: {_reason(error)}") from None
    if not data.strip(b"\0 \n"):
        raise InputError(f"{path}: {what} is empty, as a full disk leaves it; remove it to begin afresh")
    try:
        content = json.loads(data)
    except (ValueError, RecursionError) as error:
        place = f", line {error.lineno}" if isinstance(error, json.JSONDecodeError) else ""
        raise InputError(f"{path}: {what} is cut off or damaged{place}; remove it to begin afresh") from None
    if keys and not (isinstance(content, dict) and content.keys() >= set(keys)):
        raise InputError(f"{path}: {what} lacks {' or '.join(keys)}; remove it to begin afresh")
    return content


def disarmed(cell: str) -> str:
    """Text for a cell of a CSV file that a spreadsheet would take for a formula: an apostrophe before it prevents that.

    A number keeps its sign.
    """
    if not cell.lstrip().startswith(_FORMULAS) and not cell.startswith(("\t", "\r", "\n")):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell


def to_disk(folder: Path) -> None:
    """Bring what a folder lists to disk, where its file system knows how to."""
    with contextlib.suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def is_file(path: Path) -> bool:
    """Whether there is a file of that name, which may be a name that no file can have."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def named_file(name_or_path: str | Path, built_in: Mapping[str, Path], what: str) -> Path:
    """A file that comes with the project, by its name, or one by its path.

    Args:
        name_or_path: of either.
        built_in: name -> file.
        what: it is, for errors: "rig".

    Raises:
        InputError: neither; names the nearest ones.
    """
    text = str(name_or_path)
    if text in built_in:
        return built_in[text]
    path = Path(text)
    if is_file(path):
        return path
    if path.suffix in (".yaml", ".yml"):
        raise InputError(f"{what} file {path} does not exist")
    choices = f"{meant(text, built_in)}built in are {', '.join(built_in)}; or give a file"
    raise InputError(f"no {what} '{text}'; {choices}")


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
        raise InputError(f"--out {folder}: cannot write there: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    return getattr(error, "strerror", None) or str(error)
