"""The lowest place of a convex quadratic within a box: where scipy finds it, whatever the numbers' sizes."""

import numpy as np
import pytest
from scipy.optimize import lsq_linear

from hydrolek_drake.identification.least_squares.box import lowest_in_box


def _problem(seed: int, alike: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Normal equations of parameters of very different size, two of which do nearly the same."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 25))
    slopes = rng.normal(size=(40, count)) * 10.0 ** rng.uniform(-4.0, 4.0, count)
    slopes[:, -1] = slopes[:, 0] + alike * slopes[:, -1] / np.abs(slopes[:, -1]).max()
    square = slopes.T @ slopes
    square += 1e-8 * np.diag(np.diag(square))
    low = -rng.uniform(0.0, 1.0, count)
    return square, slopes.T @ rng.normal(size=40), low, low + 1.0


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("alike", [1.0, 1e-3])
def test_it_is_where_scipys_active_set_ends(seed, alike) -> None:
    square, pull, low, high = _problem(seed, alike)
    found = lowest_in_box(square, pull, low, high)
    root = np.linalg.cholesky(square).T
    reference = lsq_linear(root, np.linalg.solve(root.T, pull), (low, high), method="bvls", max_iter=1000).x
    assert np.all((low <= found) & (found <= high))

    def left(way: np.ndarray) -> float:
        return float(way @ square @ way / 2.0 - pull @ way)

    assert left(found) <= left(reference) + 1e-9 * abs(left(reference))


@pytest.mark.parametrize("seed", range(20))
def test_numbers_that_do_the_same_and_stand_at_their_edges_end(seed) -> None:
    square, pull, low, high = _problem(seed, 0.0)
    low[::2], high[::2] = 0.0, 1.0
    found = lowest_in_box(square, pull, low, high)
    assert np.all((low <= found) & (found <= high))
    slope = square @ found - pull
    tiny = 1e-6 * np.sqrt(np.diag(square)) * np.linalg.norm(pull / np.sqrt(np.diag(square)))
    assert np.all((slope >= -tiny) | np.isclose(found, high))
    assert np.all((slope <= tiny) | np.isclose(found, low))


def test_less_damping_promises_more() -> None:
    """What several numbers at their edges once broke: a Newton step that promised less than a damped one."""
    for seed in range(40):
        square, pull, low, high = _problem(seed, 1e-3)

        def promised(damping: float, square=square, pull=pull, low=low, high=high) -> float:
            way = lowest_in_box(square + damping * np.diag(np.diag(square)), pull, low, high)
            return float(pull @ way - way @ square @ way / 2.0)

        falls = [promised(damping) for damping in (1e-6, 1e-4, 1e-2, 1.0, 1e2)]
        assert falls == sorted(falls, reverse=True)
