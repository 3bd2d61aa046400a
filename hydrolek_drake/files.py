"""Writing a file so that it is either complete or not there."""

import os
from pathlib import Path


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
