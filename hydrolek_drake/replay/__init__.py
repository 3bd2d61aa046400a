"""Driving a rig's model with a recorded command, and comparing what it does with what was measured."""

import sys
from types import ModuleType
from typing import Any

from hydrolek_drake.replay.comparison import Comparison, compare
from hydrolek_drake.replay.replay import Replay, replay

__all__ = ["Comparison", "Replay", "compare", "replay"]


class _CallablePackage(ModuleType):
    """This package, which may be called too: `hydrolek_drake.replay(rig, recording)` is `hydrolek_drake.api.replay`."""

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Replay a recording, see `hydrolek_drake.api.replay`."""
        from hydrolek_drake.api import replay as as_function

        return as_function(*given, **named)


sys.modules[__name__].__class__ = _CallablePackage
