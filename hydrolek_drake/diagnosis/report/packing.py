"""Arrays of numbers in a page."""

import base64

import numpy as np


def packed(values: np.ndarray) -> str:
    """Numbers as base 64 of little-endian floats of four bytes: seven digits, NaN too. # (n,)."""
    return base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")
