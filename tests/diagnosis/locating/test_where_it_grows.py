"""Which share of a mismatch something is said to take."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.locating.place import left_at, share_of
from hydrolek_drake.identification.least_squares.least_squares import Fit

COUNTED = 1000


def _leaving(squares: float) -> Fit:
    residuals = np.full(COUNTED, np.sqrt(squares / COUNTED))
    return Fit(np.zeros(1), residuals, np.zeros(1), np.zeros((COUNTED, 1)), np.eye(1), COUNTED, 1)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(
    ("left", "taken", "share"),
    [
        (5000.0, 4000.0, 1.0),  # down to the noise
        (5000.0, 1000.0, 0.25),
        (5000.0, 4100.0, 1.0),  # and a little of the noise
        (5000.0, -10.0, 0.0),
        (900.0, 50.0, 1.0),  # the noise is told too high
        (900.0, -50.0, 0.0),
        (900.0, 0.0, 0.0),
    ],
)
def test_a_share_is_of_what_is_left_above_the_noise(left: float, taken: float, share: float) -> None:
    assert share_of(_leaving(left), taken) == pytest.approx(share)


def test_what_is_left_at_each_joint_is_what_is_left_in_all(bench, recorded) -> None:
    """Two joints with a signal more at one of them."""
    [first], [second] = recorded(bench, bench), recorded(bench, bench, pressure_noise_Pa=2e4)
    experiments = [replace(first, joint="one"), replace(second, joint="other")]
    sizes = [len(e.channels) * e.time.size for e in experiments]
    residuals = np.random.default_rng(1).standard_normal(sum(sizes))
    parts = [left_at(joint, residuals, experiments) for joint in ("one", "other")]
    assert parts[0][0] == pytest.approx(float(np.sum(residuals[: sizes[0]] ** 2)))
    assert sum(squares for squares, _ in parts) == pytest.approx(float(residuals @ residuals))
    assert [counted for _, counted in parts] == [e.counted for e in experiments]
    assert left_at("none", residuals, experiments) == (0.0, 0)
