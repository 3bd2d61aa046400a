"""What a search does, for those who want to watch it: with HYDROLEK_TRACE=1 it is printed."""

import os
import time
from collections.abc import Sequence

from hydrolek_drake.diagnosis.structures.addition import Addition


def trace(text: str) -> None:
    """Print a line if it is wanted."""
    if os.environ.get("HYDROLEK_TRACE"):
        print(f"{time.process_time():6.1f} s {text}", flush=True)


def names_of(effects: Sequence[Addition]) -> str:
    """A structure in such a line."""
    return "+".join(c.id for c in effects) or "nominal"
