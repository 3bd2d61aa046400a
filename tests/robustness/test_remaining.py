"""How long what is left may take."""

import pytest

from hydrolek_drake.runs.remaining import Remaining


def test_the_rest_takes_as_long_as_what_ended_did():
    now = [0.0]
    left = Remaining(100, clock=lambda: now[0])
    assert left.seconds() is None and left.words() == ""
    for _ in range(10):
        left.one_ended(at_once=True)  # done by an earlier run
    for _ in range(30):
        now[0] += 12.0
        left.one_ended()
    assert left.seconds() == pytest.approx(60 * 12.0) and left.words() == ", about 12 min left"
    for _ in range(58):
        now[0] += 12.0
        left.one_ended()
    assert left.words() == ", about 24 s left"
    left.one_ended()
    left.one_ended()
    assert left.words() == ""
