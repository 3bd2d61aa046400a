"""The sequential test of the innovations: as many false alarms as stated at most, and changes seen soon."""

import numpy as np
import pytest

from hydrolek_drake.watching.live.blocks import Block, Healthy
from hydrolek_drake.watching.live.detecting import ChangeDetector
from hydrolek_drake.watching.live.settings import MOST_NATS

SHAPE = 10.0
DEVIATION = 0.2


def _healthy():
    one = np.full((1, 3), np.nan)
    values = {"scale": 1.0, "deviation": DEVIATION, "square": 1.0, "shape": SHAPE}
    arrays = {name: one.copy() for name in values}
    for name, value in values.items():
        arrays[name][0, 0] = value
    return Healthy(("joint",), 0.01, **arrays)


def _block(number, mean, square):
    nothing = np.full((1, 3), np.nan)
    means, squares = nothing.copy(), nothing.copy()
    means[0, 0], squares[0, 0] = mean, square
    return Block(float(number), number + 1.0, means, squares)


def _first_alarm(rng, blocks, shift=0.0, spread=1.0, since=0, false_alarms=0.1):
    detector = ChangeDetector(_healthy(), false_alarms)
    for number in range(blocks):
        changed = number >= since
        mean = DEVIATION * (rng.standard_normal() + (shift if changed else 0.0))
        square = rng.gamma(SHAPE, 1.0 / SHAPE) * (spread if changed else 1.0)
        if detector.add(_block(number, mean, square)):
            return number, detector
    return None, detector


def test_healthy_machines_are_alarmed_no_more_often_than_stated():
    rng = np.random.default_rng(2)
    alarms = [_first_alarm(rng, 120)[0] is not None for _ in range(100)]
    assert sum(alarms) <= 16  # 10 are allowed on average, 16 and more by chance once in fifty


@pytest.mark.parametrize(("shift", "spread", "most"), [(3.0, 1.0, 12), (-3.0, 1.0, 12), (0.0, 4.0, 12)])
def test_a_change_is_seen_within_some_blocks_and_dated(shift, spread, most):
    rng = np.random.default_rng(3)
    for _ in range(5):
        number, detector = _first_alarm(rng, 200, shift, spread, since=100, false_alarms=0.005)
        assert number is not None and 100 <= number <= 100 + most
        assert detector.alarmed == number + 1.0
        which, joint, quantity = detector.first
        assert (which, joint, quantity) == (int(spread > 1.0), 0, 0)
        assert detector.since[which, 0, 0] == pytest.approx(100.0, abs=5.0)


def test_one_mishap_however_large_is_no_alarm():
    rng = np.random.default_rng(4)
    detector = ChangeDetector(_healthy(), 0.005)
    for number in range(200):
        wild = number == 120
        mean = 1e6 if wild else DEVIATION * rng.standard_normal()
        detector.add(_block(number, mean, 1e9 if wild else rng.gamma(SHAPE, 1.0 / SHAPE)))
    assert detector.alarmed is None
    assert np.nanmax(detector.evidence) < detector.threshold - MOST_NATS


def test_blocks_without_values_say_nothing():
    detector = ChangeDetector(_healthy(), 0.005)
    for number in range(100):
        detector.add(_block(number, np.nan, np.nan))
    assert detector.alarmed is None and np.nanmax(detector.evidence) <= 0.0
    assert np.isnan(detector.evidence[:, 0, 1:]).all()
