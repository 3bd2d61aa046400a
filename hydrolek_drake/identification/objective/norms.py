"""Norms of the identification error of the thesis, equations (4.12) to (4.18)."""

import math
from itertools import pairwise

import numpy as np

NORMS = (1.0, 2.0, math.inf)
"""p of the thesis."""


def mean_norm(error: np.ndarray, p: float) -> float:
    """(1/N sum |e|^p)^(1/p), equation (4.13); the largest |e| for p = infinity.

    Args:
        error: e = y - y_model (4.12), any shape.
        p: 1, 2 or infinity.
    """
    size = np.abs(error)
    if p == math.inf:
        return float(size.max())
    if p == 1.0:
        return float(size.mean())
    return float(np.mean(size**p) ** (1.0 / p))


def relative_norm(error: np.ndarray, measured: np.ndarray, p: float) -> float:
    """Equation (4.14): the error is divided by the p-norm of what was measured.

    As printed, ||y||_p is the plain norm (sum |y|^p)^(1/p), without 1/N; for each p it is a constant of the
    recording, so that (4.13) and (4.14) have the same minimum.
    """
    size = float(np.linalg.norm(np.ravel(measured), p))
    return mean_norm(error / size, p)


def segment_edges(samples: int, segments: int) -> np.ndarray:
    """First sample of each of `segments` equal parts, and the end. # (segments + 1,)."""
    return np.linspace(0, samples, segments + 1).round().astype(int)


def segment_norms(error: np.ndarray, segments: int, p: float) -> np.ndarray:
    """J_mul, equation (4.17): the norm (4.18) of each segment.

    Args:
        error: in the order of time along the first axis.
        segments: how many equal parts.
        p: 1, 2 or infinity.

    Returns:
        # (segments,)
    """
    edges = segment_edges(len(error), segments)
    return np.array([mean_norm(error[a:b], p) for a, b in pairwise(edges)])
