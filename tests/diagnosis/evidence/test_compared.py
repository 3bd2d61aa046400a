"""Differences of evidence with their standard errors."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judged import Judged, with_differences
from hydrolek_drake.diagnosis.settings import EVIDENCE
from hydrolek_drake.diagnosis.structures.splitting import halves


@pytest.fixture
def held_out(bench, recorded):
    return halves(recorded(bench, bench))[1]


def _judged(held_out, residuals):
    counts = np.concatenate([np.tile(e.used, len(e.channels)) for e in held_out])
    return Judged(None, residuals * counts, int(counts.sum()))  # type: ignore[arg-type]


def test_a_difference_is_that_of_the_squares_and_its_error_that_of_the_blocks(held_out) -> None:
    rng = np.random.default_rng(3)
    size = sum(len(e.channels) * e.time.size for e in held_out)
    noise = rng.standard_normal(size)
    best, worse = _judged(held_out, noise), _judged(held_out, noise + 0.3)
    first, second = with_differences([best, worse], held_out)
    assert first.behind == 0.0
    squares = float(worse.held_out @ worse.held_out - best.held_out @ best.held_out)
    assert second.behind == pytest.approx(0.5 * squares)
    # sum of n terms 0.3 e + 0.045 with independent e
    assert second.behind_error == pytest.approx(0.3 * np.sqrt(best.held_out_counted), rel=0.7)
    assert second.behind > EVIDENCE.deviations * second.behind_error


def test_of_two_that_differ_by_chance_few_are_told_apart(held_out) -> None:
    """Two standard errors from nine blocks hold 92 of 100 (Student's t)."""
    rng = np.random.default_rng(4)
    size = sum(len(e.channels) * e.time.size for e in held_out)
    told = 0
    for _ in range(100):
        one, other = (_judged(held_out, rng.standard_normal(size)) for _ in range(2))
        _, second = with_differences([one, other], held_out)
        told += abs(second.behind) >= EVIDENCE.deviations * second.behind_error
    assert told <= 17  # 8 expected, and three standard deviations of a count
