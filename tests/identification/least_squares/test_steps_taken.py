"""A fit ends where scipy's ends, without the Jacobian that nobody asked for."""

import numpy as np
import pytest
from scipy.optimize import OptimizeResult, least_squares

from hydrolek_drake.identification.least_squares.least_squares import EDGE, fit_from

VALUES, PARAMETERS = 60, 4


class Bent:
    """Residuals that bend and have kinks, with a prior."""

    counted = VALUES
    unsure = admitted = 0.0

    def __init__(self, rng: np.random.Generator) -> None:
        self.waves, self.kinks = rng.normal(size=(2, VALUES, PARAMETERS))
        self.measured = rng.normal(size=VALUES)
        self.evaluations = 0
        self.jacobians = 0

    def residuals(self, unit: np.ndarray) -> np.ndarray:
        self.evaluations += 1
        return np.sin(4.0 * self.waves @ unit) + np.abs(3.0 * self.kinks @ (unit - 0.3)) - self.measured

    def jacobian(
        self, unit: np.ndarray, at: np.ndarray | None = None, moving: np.ndarray | None = None
    ) -> np.ndarray:
        self.jacobians += 1
        return (
            4.0 * self.waves * np.cos(4.0 * self.waves @ unit)[:, None]
            + 3.0 * self.kinks * np.sign(self.kinks @ (unit - 0.3))[:, None]
        )

    def leading_slopes(self, unit: np.ndarray, at: np.ndarray, moving: np.ndarray | None = None) -> None:
        return None

    def prior_residuals(self, unit: np.ndarray) -> np.ndarray:
        return (unit - 0.5) / 0.3

    def prior_jacobian(self) -> np.ndarray:
        return np.eye(PARAMETERS) / 0.3


def by_scipy(bent: Bent, start: np.ndarray, most_steps: int, tolerance: float) -> OptimizeResult:
    return least_squares(
        lambda unit: np.concatenate([bent.residuals(unit), bent.prior_residuals(unit)]),
        np.clip(start, EDGE, 1.0 - EDGE),
        jac=lambda unit: np.concatenate([bent.jacobian(unit), bent.prior_jacobian()]),
        bounds=(0.0, 1.0),
        max_nfev=most_steps,
        xtol=tolerance,
        ftol=tolerance,
        gtol=1e-12,
    )


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("most_steps", [1, 4, 15])
def test_a_fit_ends_where_scipys_ends_with_one_jacobian_less(most_steps, tolerance) -> None:
    rng = np.random.default_rng(1)
    spared = 0
    for _ in range(20):
        bent, start = Bent(rng), rng.uniform(size=PARAMETERS)
        fit = fit_from(bent, start, most_steps=most_steps, tolerance=tolerance)
        used, bent.jacobians, tried = bent.jacobians, 0, fit.evaluations
        before = bent.evaluations
        there = by_scipy(bent, start, most_steps, tolerance)
        assert tried == bent.evaluations - before
        np.testing.assert_allclose(fit.unit, there.x, atol=1e-9)
        assert 0 <= bent.jacobians - used <= 1
        spared += bent.jacobians - used
        np.testing.assert_allclose(fit.jacobian, there.jac[:VALUES], atol=1e-6)
    assert spared >= 15  # of twenty: some fits end with steps that were not taken


def test_a_jacobian_is_computed_once_and_only_where_it_is_asked_for() -> None:
    bent = Bent(np.random.default_rng(2))
    fit = fit_from(bent, np.full(PARAMETERS, 0.4), most_steps=3)
    used = bent.jacobians
    first = fit.jacobian
    assert bent.jacobians == used + 1
    assert fit.jacobian is first
    assert bent.jacobians == used + 1


def test_with_a_robust_loss_a_fit_ends_where_scipys_ends() -> None:
    bent = Bent(np.random.default_rng(3))
    fit = fit_from(bent, np.full(PARAMETERS, 0.4), loss="soft_l1", most_steps=30, tolerance=1e-3)
    there = least_squares(
        lambda unit: np.concatenate([bent.residuals(unit), bent.prior_residuals(unit)]),
        np.full(PARAMETERS, 0.4),
        jac=lambda unit: np.concatenate([bent.jacobian(unit), bent.prior_jacobian()]),
        bounds=(0.0, 1.0),
        loss="soft_l1",
        max_nfev=30,
        xtol=1e-3,
        ftol=1e-3,
        gtol=1e-12,
    )
    np.testing.assert_allclose(fit.unit, there.x, atol=1e-9)
