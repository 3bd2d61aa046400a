"""The process in which a reader of this folder runs: `python -m hydrolek_drake.recordings.apart.child`.

Arguments are the reader's module, the path, the seconds that it may take, and what is asked in JSON. A reader
has a function `load(asked)`, and `read(path, asked)`, which yields `Found` and may raise `InputError` without
the file's name.
"""

import contextlib
import io
import json
import math
import os
import resource
import sys
import time
from importlib import import_module
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.apart.found import Asked

REFUSED = 3
"""Exit status where the reader has said in one line what is wrong with the file."""

MEMORY, UNPACKED = 4_000_000_000, 100_000_000
PER_BYTE = 40
"""Bytes that the process may take and write, and more of them for each byte of the file: nothing that is
measured packs better."""


def main() -> None:
    """Read the file that the command line names and write its columns to standard output as .npz."""
    reader, path, seconds, text = sys.argv[1:]
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what packages print must not come between
    _limit_size(Path(path))
    options = json.loads(text)
    asked = Asked(frozenset(options.pop("mapped")), options)
    module = import_module(f"hydrolek_drake.recordings.apart.{reader}")
    module.load(asked)
    _limit(
        resource.RLIMIT_CPU, math.ceil(time.process_time()) + int(seconds)
    )  # ends whatever compiled code is at
    try:
        found = list(module.read(Path(path), asked))
    except InputError as error:
        print(" ".join(str(error).split()), file=sys.stderr)
        sys.exit(REFUSED)
    except MemoryError:
        sys.exit("it asks for more memory than a sound file does")
    heads = json.dumps([{"names": each.names, "group": each.group} for each in found])
    archive = io.BytesIO()
    arrays = (np.zeros(0) if each.values is None else each.values for each in found)
    np.savez(archive, np.frombuffer(heads.encode(), dtype=np.uint8), *arrays)
    out.write(archive.getbuffer())
    out.close()


def _limit_size(path: Path) -> None:
    files = [path] if path.is_file() else [each for each in path.iterdir() if each.is_file()]
    size = sum(each.stat().st_size for each in files)
    for kind, allowed in ((resource.RLIMIT_AS, MEMORY), (resource.RLIMIT_FSIZE, UNPACKED)):
        _limit(kind, allowed + PER_BYTE * size)


def _limit(kind: int, most: int) -> None:
    _, hard = resource.getrlimit(kind)
    with contextlib.suppress(ValueError, OSError):  # not every system has every limit
        resource.setrlimit(kind, (most if hard < 0 else min(most, hard), hard))


if __name__ == "__main__":
    main()
