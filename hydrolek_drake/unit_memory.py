"""Factors of units that were converted before, kept on disk: the package for units takes half a second to load."""

import atexit
import contextlib
import json
import math
import os
from functools import cache
from importlib.metadata import version
from pathlib import Path

from hydrolek_drake.files import write_whole


@cache
def _file() -> Path:
    home = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    return home / "hydrolek_drake" / f"units_{version('pint')}.json"


@cache
def _known() -> dict[str, float]:
    """What is on disk; nothing if it cannot be read."""
    with contextlib.suppress(OSError, ValueError, RecursionError, RuntimeError):  # the last: there is no home
        found = json.loads(_file().read_text(encoding="utf-8"))
        if isinstance(found, dict) and all(
            isinstance(f, float) and 0.0 < f < math.inf for f in found.values()
        ):
            return found
    return {}


def remembered(unit: str, si_unit: str) -> float | None:
    """The factor from `unit` to `si_unit`, if it is known."""
    return _known().get(f"{unit}\t{si_unit}")


def remember(unit: str, si_unit: str, factor: float) -> None:
    """Keep a factor; it is written when the program ends."""
    if not _added:
        atexit.register(_write)
    _added[f"{unit}\t{si_unit}"] = factor


_added: dict[str, float] = {}


def _write() -> None:
    with contextlib.suppress(OSError, RuntimeError):  # a read-only home, or none: converted anew in each run
        _file().parent.mkdir(parents=True, exist_ok=True)
        _known.cache_clear()  # other programs may have added theirs meanwhile
        write_whole(_file(), json.dumps(_known() | _added, indent=0, sort_keys=True))
