"""What a search does, for those who want to watch it: with HYDROLEK_TRACE=1 it is printed."""

import os
import time


def trace(text: str) -> None:
    """Print a line if it is wanted."""
    if os.environ.get("HYDROLEK_TRACE"):
        print(f"{time.process_time():6.1f} s {text}", flush=True)
