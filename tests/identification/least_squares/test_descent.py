"""A fit that is led by slopes which are not quite right ends where the Jacobian leads, for fewer of these."""

import numpy as np
import pytest

from hydrolek_drake.identification.least_squares.least_squares import ROUGH, fit_from

VALUES, PARAMETERS = 200, 3
OFF = 0.3


class Land:
    """Residuals that bend a little, under noise; slopes that lead are off by `OFF` of themselves, or there are none."""

    counted, unsure, admitted = VALUES, 0.0, 0.0

    def __init__(self, *, leads: bool) -> None:
        rng = np.random.default_rng(8)
        self.waves = rng.normal(size=(VALUES, PARAMETERS))
        self.measured = 8.0 * np.sin(self.waves @ np.full(PARAMETERS, 0.4)) + rng.normal(size=VALUES)
        self.wrong = 1.0 + OFF * rng.normal(size=(VALUES, PARAMETERS))
        self.leads, self.evaluations, self.jacobians = leads, 0, 0

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        self.evaluations += 1
        return 8.0 * np.sin(self.waves @ unit) - self.measured

    def slopes(self, unit: np.ndarray) -> np.ndarray:
        return 8.0 * self.waves * np.cos(self.waves @ unit)[:, None]

    def jacobian(self, unit: np.ndarray, at: object = None, moving: object = None) -> np.ndarray:
        self.jacobians += 1
        return self.slopes(unit)

    def leading_slopes(self, unit: np.ndarray, at: np.ndarray, moving: object = None) -> np.ndarray | None:
        return self.wrong * self.slopes(unit) if self.leads else None

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        return np.zeros(0)

    def prior_jacobian(self) -> np.ndarray:
        return np.zeros((0, PARAMETERS))


def test_a_fit_ends_where_the_jacobian_leads() -> None:
    led, alone = Land(leads=True), Land(leads=False)
    start = np.full(PARAMETERS, 0.8)
    fit, exact = fit_from(led, start, tolerance=1e-8), fit_from(alone, start, tolerance=1e-8)
    np.testing.assert_allclose(fit.unit, exact.unit, atol=1e-6)
    assert fit.objective == pytest.approx(exact.objective, abs=1e-6)
    assert 0 < led.jacobians < alone.jacobians
    # told by the Jacobian, whatever led there
    np.testing.assert_array_equal(fit.jacobian, led.slopes(fit.unit))


def test_a_fit_that_only_leads_to_others_ends_without_a_jacobian() -> None:
    land = Land(leads=True)
    fit = fit_from(land, np.full(PARAMETERS, 0.8), tolerance=ROUGH)
    assert land.jacobians == 0
    assert fit.over_noise < 1.2


def test_steps_are_counted_over_both_legs() -> None:
    land = Land(leads=True)
    fit_from(land, np.full(PARAMETERS, 0.8), tolerance=1e-12, most_steps=6)
    assert land.evaluations <= 6 and land.jacobians == 0
    land = Land(leads=True)
    fit_from(land, np.full(PARAMETERS, 0.8), tolerance=1e-6, most_steps=50)
    assert land.jacobians > 0
