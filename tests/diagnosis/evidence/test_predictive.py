"""The predictive likelihood of held-out data against its plain formula and its meaning."""

import numpy as np
import pytest

from hydrolek_drake.diagnosis.evidence.judging import predictive
from hydrolek_drake.diagnosis.structures.workbench import SPREAD
from hydrolek_drake.identification.least_squares.least_squares import Fit

VALUES, PARAMETERS = 60, 4


def _fit(jacobian: np.ndarray, unit: np.ndarray) -> Fit:
    prior = np.diag([1.0 / SPREAD, 1.0 / SPREAD, 0.0, 0.0])  # two nominal parameters, two of an effect
    return Fit(unit, np.zeros(len(jacobian)), np.zeros(PARAMETERS), jacobian, prior, len(jacobian), 1)


def _covariance(jacobian: np.ndarray) -> np.ndarray:
    return np.linalg.inv(jacobian.T @ jacobian + np.eye(PARAMETERS) / SPREAD**2)


def test_it_is_the_likelihood_of_a_normal_distribution() -> None:
    rng = np.random.default_rng(1)
    fitted, ahead = rng.normal(size=(80, PARAMETERS)), 5.0 * rng.normal(size=(VALUES, PARAMETERS))
    residuals = rng.normal(size=VALUES)
    covariance = np.eye(VALUES) + ahead @ _covariance(fitted) @ ahead.T
    shares, spread = predictive(residuals, ahead, _fit(fitted, np.full(PARAMETERS, 0.5)))
    assert shares.sum() == pytest.approx(residuals @ np.linalg.solve(covariance, residuals), rel=1e-9)
    assert spread == pytest.approx(np.linalg.slogdet(covariance)[1], rel=1e-9)


def test_a_model_that_is_right_leaves_one_for_each_value_however_uncertain_its_parameters() -> None:
    rng = np.random.default_rng(2)
    fitted = rng.normal(size=(8, PARAMETERS))  # few training data: the parameters stay uncertain
    ahead = 20.0 * rng.normal(size=(VALUES, PARAMETERS))
    covariance = _covariance(fitted)
    plain, judged = [], []
    for _ in range(400):
        off = rng.multivariate_normal(np.zeros(PARAMETERS), covariance)
        residuals = rng.normal(size=VALUES) + ahead @ off
        plain.append(float(residuals @ residuals) / VALUES)
        judged.append(predictive(residuals, ahead, _fit(fitted, np.full(PARAMETERS, 0.5)))[0].sum() / VALUES)
    assert np.mean(plain) > 5.0
    # the mean of 400 * 60 squared normal values is known to 1.414 / sqrt(24 000) = 0.9 %
    assert np.mean(judged) == pytest.approx(1.0, abs=0.03)
