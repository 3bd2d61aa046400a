"""The lowest place of a convex quadratic within a box."""

import numpy as np

PATIENCE = 3
"""So many exchanges that leave no fewer wrong are tried before one number is exchanged at a time, which always ends."""

MOST = 100
"""So many exchanges for each number at most: by then rounding goes round in circles, which a fit must not wait for."""


def lowest_in_box(square: np.ndarray, pull: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The x that minimises x' square x / 2 - pull' x between two bounds.

    By block principal pivoting (Judice and Pires, Computers and Operations Research 21 (1994) 587): numbers that are
    out of their box go to its edge, those at an edge from which the slope leads inwards are set free, all at once, and
    where that goes round in circles one by one, which ends (Murty, Linear Algebra and its Applications 7 (1974) 283).

    After `MOST` exchanges the place that they have led to is returned, within the box.

    Args:
        square: symmetric, positive definite. # (n, n)
        pull: the downhill slope at zero. # (n,)
        low: lower bounds. # (n,)
        high: upper bounds. # (n,)
    """
    scale = 1.0 / np.sqrt(
        np.diag(square)
    )  # numbers of very different size are then told to the same accuracy
    square, pull = square * np.outer(scale, scale), pull * scale
    lower, upper = low / scale, high / scale
    at = np.zeros(pull.size, dtype=int)  # -1 at the lower edge, 1 at the upper one, 0 free
    fewest, patience = pull.size + 1, PATIENCE
    way = np.zeros(pull.size)  # where there is no number
    for _ in range(MOST * pull.size):
        way = np.where(at < 0, lower, upper)
        free = at == 0
        if free.any():
            beside = square[np.ix_(free, ~free)] @ way[~free]
            way[free] = np.linalg.solve(square[np.ix_(free, free)], pull[free] - beside)
        slope = square @ way - pull
        should = np.where(free & (way < lower), -1, np.where(free & (way > upper), 1, at))
        should = np.where(((at < 0) & (slope < 0.0)) | ((at > 0) & (slope > 0.0)), 0, should)
        wrong = np.flatnonzero(should != at)
        if not wrong.size:
            break
        if wrong.size < fewest:
            fewest, patience = wrong.size, PATIENCE
        elif patience:
            patience -= 1
        else:
            wrong = wrong[-1:]
        at[wrong] = should[wrong]
    return np.clip(way * scale, low, high)
