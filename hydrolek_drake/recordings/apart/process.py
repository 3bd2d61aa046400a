"""Columns of a file, read by another package in a process of its own.

Compiled parsers trust the lengths that a file states: one damaged byte can end the whole interpreter with a
segmentation fault, which no `except` can catch, or keep it busy for ever; a compressed file of a few bytes
can ask for all memory. In a process of its own a parser only ends that, or is ended.
"""

import importlib.util
import io
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.apart.child import REFUSED
from hydrolek_drake.recordings.table import Column

LONGEST_S = 2.0
BYTES_PER_S = 2e6
"""What reading may take once its package is loaded; it takes a tenth of a second, and another second for each
10 to 100 MB."""

START_S = 60.0
"""What loading a package may take besides; it takes half a second."""

_BUSY = 4.0
"""So many times its processor time may pass on a machine that has other work."""

_CHILD = ("-m", "hydrolek_drake.recordings.apart.child")

_EXTRA = "hydrolek-drake[formats]"


def missing(package: str, what: str) -> str:
    """What to install for files that need a package which the bare installation does not bring; "" if it is there."""
    if importlib.util.find_spec(package) is not None:
        return ""
    return f"{what} are read by a package that is not installed: pip install '{_EXTRA}'"


def columns_apart(
    reader: str,
    path: Path,
    mapped: Iterable[str] = (),
    *,
    bytes_per_s: float = BYTES_PER_S,
    **options: object,
) -> list[Column]:
    """Columns that a reader of this folder finds in a file.

    Args:
        reader: Name of its module.
        path: File or folder.
        mapped: Names that the rig maps: what is not among them and has no name of the contract need not be read.
        bytes_per_s: What the reader reads in a second at least.
        options: Further settings of the reader.

    Returns:
        Columns; those that were not read have no values.

    Raises:
        InputError: The reader says what is wrong with the file.
        ValueError: The file is damaged, or takes longer than `LONGEST_S` and a second for each `bytes_per_s`.
    """
    limit = math.ceil(LONGEST_S + _size(path) / bytes_per_s)
    asked = {"mapped": sorted(mapped), **options}
    with tempfile.TemporaryDirectory() as scratch:
        environment = os.environ | {
            "PYTHONPATH": os.pathsep.join(place or os.getcwd() for place in sys.path),
            "PYTHONSAFEPATH": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "TMPDIR": scratch,  # what is unpacked there goes with it, even where the process is ended
        }
        arguments = [*_CHILD, reader, str(path.absolute()), str(limit), json.dumps(asked)]
        try:
            done = subprocess.run(  # kills the process where the time is up
                [sys.executable, *arguments],
                stdin=subprocess.DEVNULL,
                capture_output=True,
                env=environment,
                check=False,
                timeout=_BUSY * limit + START_S,
            )
        except subprocess.TimeoutExpired:
            raise ValueError(f"its reader did not end within {_BUSY * limit + START_S:.0f} s") from None
    said = done.stderr.decode(errors="replace").strip().splitlines()
    if done.returncode == -signal.SIGXCPU:
        raise ValueError(
            f"it was not read within {limit} s of processor time, of which a sound file needs a part; save it anew"
        )
    if done.returncode == REFUSED and said:
        raise InputError(f"{path}: {said[-1]}")
    if done.returncode != 0:
        raise ValueError(said[-1] if said and done.returncode > 0 else "its contents contradict each other")
    content = np.load(io.BytesIO(done.stdout), allow_pickle=False)
    heads, *arrays = (content[key] for key in content.files)
    return [
        Column(tuple(head["names"]), values, head["group"])
        for head, values in zip(json.loads(heads.tobytes()), arrays, strict=True)
    ]


def _size(path: Path) -> int:
    """Bytes of a file, or of all files of a folder."""
    if not path.is_dir():
        return path.stat().st_size
    return sum(each.stat().st_size for each in path.iterdir() if each.is_file())
