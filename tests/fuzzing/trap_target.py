"""A target that fails in each way there is, by the number of its input: the runner has to notice all of them."""

import os
import time
from pathlib import Path

import numpy as np

from fuzzing.target import Input, Target
from hydrolek_drake.errors import InputError

WAYS = ("read", "refused", "unnamed", "raises", "crashes", "hangs")


def _make(rng: np.random.Generator) -> Input:
    return Input("trap.txt", WAYS[rng.integers(len(WAYS))].encode())


def _call(path: Path) -> str:
    match path.read_text():
        case "refused":
            raise InputError(f"{path}: no good")
        case "unnamed":
            raise InputError("something is no good")
        case "raises":
            raise ZeroDivisionError
        case "crashes":
            os.abort()
        case "hangs":
            time.sleep(60.0)
    return "read"


TARGETS = (Target("trap", _make, _call, lambda: [Input("trap.txt", b"read")]),)
