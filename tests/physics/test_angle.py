"""Sines and cosines of angles that are close to a known one are those of the library."""

import numpy as np
import pytest

from hydrolek_drake.physics.angle import CLOSE, angle, angle_near

ROUNDING = 4.0 * np.finfo(float).eps


@pytest.mark.parametrize("away", [0.0, 1e-9, 1e-3, 0.9 * CLOSE, 1.1 * CLOSE, 2.0])
def test_it_is_the_library_s_to_rounding(away: float) -> None:
    for known in np.linspace(-4.0, 4.0, 81).tolist():
        for value in (known - away, known + away):
            told = angle_near(value, angle(known))
            assert told.value == value
            assert told.sine == pytest.approx(np.sin(value), abs=ROUNDING)
            assert told.cosine == pytest.approx(np.cos(value), abs=ROUNDING)


def test_no_number_has_no_sine() -> None:
    assert np.isnan(angle_near(np.nan, angle(0.3))[1:]).all()
