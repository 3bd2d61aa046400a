"""Where the machine code of the compiled physics is kept between runs.

Numba notices a change in the file of a cached function, but not in the files of the functions that it
calls. The cache folder is therefore named after a hash of everything that is compiled: after any edit of
the physics, an effect or the rollout, a fresh folder is used.
"""

import hashlib
import os
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

_COMPILED_PARTS = ("physics", "effects", "rollout", "systems", "kinematics", "vision", "challenge")
_CHOSEN, _OURS = (
    "NUMBA_CACHE_DIR",
    "HYDROLEK_CACHE_DIR",
)  # the user's, or ours; also told to processes that are begun


def use_cache_for_this_source() -> None:
    """Point numba's cache at a folder that belongs to exactly this source (unless the user chose one).

    Numba itself is not loaded for that, since commands that compile nothing do without it.
    """
    chosen = os.environ.get(_CHOSEN)
    if chosen and chosen != os.environ.get(_OURS):
        return
    package = Path(__file__).parent
    digest = hashlib.sha256(version("numba").encode())
    files = [file for part in _COMPILED_PARTS for file in sorted((package / part).rglob("*.py"))]
    for file in (package / "compiling.py", *files):
        digest.update(file.relative_to(package).as_posix().encode())
        digest.update(file.read_bytes())
    home = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    folder = home / "hydrolek_drake" / digest.hexdigest()[:16]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:  # a read-only home: compile anew in each run rather than fail
        folder = Path(tempfile.mkdtemp(prefix="hydrolek_drake_"))
    os.environ[_CHOSEN] = os.environ[_OURS] = str(folder)
    if "numba" in sys.modules:
        sys.modules["numba"].config.CACHE_DIR = str(folder)


def read_only(values: ArrayLike) -> NDArray[np.float64]:
    """Values as a compiled function is given them: contiguous and not to be written.

    Numba compiles a function anew for an argument that may be written where before it might not, or the other way
    round; for the rollout that takes half a minute. The values themselves are not copied if they need not be.
    """
    given = np.ascontiguousarray(values, dtype=float).view()
    given.flags.writeable = False
    return given
