"""What is said of a profile's ends: a range that ended is not a curve that was cut off."""

import numpy as np
import pytest

from hydrolek_drake.identification.fit.profiles import RigProfile
from hydrolek_drake.identification.least_squares.profile import Profile
from hydrolek_drake.identification.parameter_set import Free

PRESSURE = Free("supply.pressure", 1e6, 3e6, False)


def _told(places, low, high, *, interrupted=False, improved=0.0) -> str:
    curve = Profile(
        index=0,
        places=np.array(places),
        growth=np.zeros(len(places)),
        threshold=3.84,
        low=low,
        high=high,
        improved=improved,
        lowest=np.zeros(1),
        evaluations=0,
        interrupted=interrupted,
    )
    return RigProfile(PRESSURE, "Pa", curve, 2e6, 0.1).sentence()


def test_ends_are_told_in_si() -> None:
    assert "1.2e+06 to 2.8e+06 Pa" in _told([0.05, 0.5, 0.95], 0.1, 0.9)


def test_a_side_that_stays_below_the_threshold_up_to_its_range_s_end_is_not_bounded() -> None:
    assert "not bounded above 1e+06 to not bounded below 3e+06 Pa" in _told([0.0, 0.5, 1.0], None, None)


@pytest.mark.parametrize("interrupted", [True, False])
def test_a_side_that_was_cut_off_is_not_called_unbounded(interrupted) -> None:
    text = _told([0.25, 0.5, 0.75], None, None, interrupted=interrupted)
    assert "less than 1.5e+06, how far was not computed to more than 2.5e+06" in text
    assert "not bounded" not in text
    assert text.endswith("; interrupted") is interrupted
