"""A fit that ended in a small hollow goes on along what the data tell least."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.identification.least_squares import fit_from
from hydrolek_drake.identification.valleys import GAIN, SHORTEST, along_valleys, ways

STIFF, WEAK, TEETH, STEEP, LOWEST = 1e3, 20.0, 10.0, 60.0, 0.2


def _land(prior: float = 0.0):
    """A valley u_0 = u_1, which falls towards `LOWEST`, with a hollow at every tenth of its way."""

    def residuals(unit: np.ndarray) -> np.ndarray:
        tooth = (unit[1] % (1.0 / TEETH)) * STEEP
        return np.array([STIFF * (unit[0] - unit[1]), WEAK * (unit[1] - LOWEST), tooth])

    def jacobian(unit, at=None, moving=None) -> np.ndarray:
        slopes = np.array([[STIFF, -STIFF, 0.0], [0.0, WEAK, 0.0], [0.0, STEEP, 0.0]])
        return slopes if moving is None else slopes * moving

    return SimpleNamespace(
        evaluations=0,
        counted=3,
        unsure=0.0,
        residuals=residuals,
        jacobian=jacobian,
        leading_slopes=lambda unit, at, moving=None: None,
        prior_residuals=lambda unit: prior * (unit - 0.5),
        prior_jacobian=lambda: prior * np.eye(3),
    )


def test_the_lowest_hollow_is_found_from_another_one() -> None:
    land = _land()
    stuck = fit_from(land, np.array([0.93, 0.93, 0.5]), tolerance=1e-6)
    assert stuck.unit[1] > LOWEST + 0.05
    gone = along_valleys(land, stuck, 1e-6)
    assert stuck.objective > 3.0 * GAIN
    assert gone.objective < GAIN
    assert gone.unit[:2] == pytest.approx([LOWEST, LOWEST], abs=1.0 / STEEP)


def test_the_lowest_place_stays() -> None:
    land = _land(prior=1.0)
    lowest = fit_from(land, np.array([0.21, 0.21, 0.5]), tolerance=1e-6)
    assert along_valleys(land, lowest, 1e-6) is lowest


def test_what_is_held_is_not_moved() -> None:
    land = _land()
    moving = np.array([True, False, True])
    held = fit_from(land, np.array([0.93, 0.93, 0.5]), tolerance=1e-6, moving=moving)
    assert along_valleys(land, held, 1e-6, moving=moving).unit[1] == 0.93


def test_ways_stay_within_the_ranges_and_lead_beyond_what_is_as_likely() -> None:
    land = _land(prior=0.3)
    fit = fit_from(land, np.array([0.93, 0.93, 0.5]), tolerance=1e-6)
    told = fit.with_prior
    found = ways(fit)
    assert len(found) > 4
    for way in found:
        assert ((fit.unit + way) > -1e-9).all() and ((fit.unit + way) < 1.0 + 1e-9).all()
        assert np.linalg.norm(told @ way) > 0.999 * SHORTEST


def test_an_interrupt_ends_it() -> None:
    land = _land()
    stuck = fit_from(land, np.array([0.93, 0.93, 0.5]), tolerance=1e-6)
    assert along_valleys(land, stuck, 1e-6, stop=lambda: True) is stuck
