"""Digital twin of hydraulic manipulators on Drake.

For notebooks and scripts, each loaded when it is first asked for: `load_rig`, `read`, `replay`, `fit`, `diagnose`,
`watch` and `to_pandas` (`hydrolek_drake.api`).
"""

import importlib
from typing import Any

from hydrolek_drake.compiled import use_cache_for_this_source

__version__ = "1.0.0"

FUNCTIONS = ("diagnose", "fit", "load_rig", "read", "replay", "to_pandas", "watch")

use_cache_for_this_source()


def __getattr__(name: str) -> Any:
    """The functions of `hydrolek_drake.api`."""
    if name not in FUNCTIONS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    if name == "replay":  # a package of that name, which may be called
        return importlib.import_module("hydrolek_drake.replay")
    return getattr(importlib.import_module("hydrolek_drake.api"), name)


def __dir__() -> list[str]:
    """Names of the package, and the functions that are loaded when asked for."""
    return sorted({*globals(), *FUNCTIONS})
