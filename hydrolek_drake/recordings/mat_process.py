"""Variables of a MATLAB file of version 5 to 7, read by SciPy in a process of its own.

SciPy's compiled parser trusts the lengths that the file states: one damaged byte can end the whole
interpreter with a segmentation fault, which no `except` can catch, or keep it busy for ever. In a process of its
own it only ends that, or is ended.
"""

import io
import math
import os
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

LONGEST_S = 5.0
BYTES_PER_S = 2e6
"""What reading may take once SciPy is loaded; it takes a tenth of a second, and another second for each 100 MB."""

START_S = 60.0
"""What loading SciPy may take besides; it takes a third of a second."""

_RUN_ALONE = "import runpy, sys; runpy.run_path(sys.argv.pop(1), run_name='__main__')"
"""Runs this file without the package around it, whose readers take as long to load as SciPy."""


def mat_variables(path: Path) -> list[tuple[str, np.ndarray]]:
    """Numeric and text arrays of a MATLAB file, fields of structs as `struct.field`.

    Raises:
        ValueError: The file is damaged, or takes longer than `LONGEST_S` and a second for each `BYTES_PER_S`.
    """
    limit = math.ceil(LONGEST_S + path.stat().st_size / BYTES_PER_S)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(place or os.getcwd() for place in sys.path)}
    try:
        child = subprocess.run(  # kills the process where the time is up
            [sys.executable, "-c", _RUN_ALONE, __file__, str(path.absolute()), str(limit)],
            stdin=subprocess.DEVNULL,
            capture_output=True,
            env=environment,
            check=False,
            timeout=START_S + limit,
        )
    except subprocess.TimeoutExpired:
        raise ValueError(f"its reader did not end within {START_S + limit:.0f} s") from None
    if child.returncode == -signal.SIGALRM:
        raise ValueError(
            f"it was not read within {limit} s, of which a sound file needs a part; save it anew"
        )
    if child.returncode != 0:
        said = child.stderr.decode(errors="replace").strip().splitlines()
        raise ValueError(said[-1] if said and child.returncode > 0 else "its contents contradict each other")
    content = np.load(io.BytesIO(child.stdout), allow_pickle=False)
    names, *arrays = (content[key] for key in content.files)
    return list(zip(names.tolist(), arrays, strict=True))


def main() -> None:
    """Load the file that the command line names and write its variables to standard output as .npz."""
    from scipy.io import loadmat

    signal.alarm(int(sys.argv[2]))  # ends this process, whatever compiled code is at
    content = loadmat(sys.argv[1], simplify_cells=True)
    variables = list(
        _flattened({name: value for name, value in content.items() if not name.startswith("__")})
    )
    archive = io.BytesIO()
    np.savez(
        archive, np.array([name for name, _ in variables], dtype=str), *(values for _, values in variables)
    )
    sys.stdout.buffer.write(archive.getbuffer())


def _flattened(struct: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, np.ndarray]]:
    for name, value in struct.items():
        if isinstance(value, Mapping):
            yield from _flattened(value, f"{prefix}{name}.")
        elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
            yield f"{prefix}{name}", value


if __name__ == "__main__":
    main()
