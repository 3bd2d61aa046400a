"""Intervals where residuals are coloured: Huber (1967), White (1982), against the closed form of a mean."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.signal import lfilter

from hydrolek_drake.diagnosis.intervals.curvature import NORMAL, beyond_curvature, intervals_of
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.identification.parameter_set import Free

SAMPLES = 4000


def fitted(noise: np.ndarray) -> Fit:
    """A constant and a slope over time fitted to noise alone, with a weak prior."""
    regressors = np.stack([np.ones(SAMPLES), np.linspace(-1.0, 1.0, SAMPLES)], axis=1)
    offset, *_ = np.linalg.lstsq(regressors, noise, rcond=None)
    residuals = noise - regressors @ offset
    return Fit(0.5 + offset, residuals, np.zeros(2), -regressors, 1e-6 * np.eye(2), SAMPLES, 1)


def coloured(rho: float, rng: np.random.Generator) -> np.ndarray:
    """Noise of variance 1 whose neighbours correlate by rho."""
    white = rng.standard_normal(SAMPLES + 500)
    return math.sqrt(1.0 - rho**2) * lfilter([1.0], [1.0, -rho], white)[500:]


@pytest.fixture
def recording() -> list[SimpleNamespace]:
    """What is asked of an experiment: one channel, every sample counts."""
    return [SimpleNamespace(channels=(None,), time=np.arange(SAMPLES) * 0.01, used=np.ones(SAMPLES, bool))]


@pytest.mark.parametrize("rho", [0.0, 0.8, 0.95])
def test_a_mean_of_coloured_noise_varies_as_its_closed_form_says(rho, recording):
    """The variance of a mean of first-order noise is (1 + rho)/(1 - rho) times that of white noise."""
    rng = np.random.default_rng(5)
    times = np.array([beyond_curvature(fitted(coloured(rho, rng)), recording) for _ in range(200)])
    expected = math.sqrt((1.0 + rho) / (1.0 - rho))
    # 18 blocks tell a deviation to a sixth, and of what varies over them two fitted numbers take a ninth
    assert_allclose(np.sqrt(np.mean(times**2, axis=0)), expected, rtol=1.0 / 6.0)
    assert np.all(times >= 1.0)


@pytest.mark.parametrize("rho", [0.0, 0.9])
def test_intervals_hold_as_often_as_they_say(rho, recording):
    rng = np.random.default_rng(6)
    free = [Free(name, 0.0, 1.0, log=False) for name in ("offset", "slope")]
    parameters = SimpleNamespace(free=free)
    held = []
    for _ in range(400):
        fit = fitted(coloured(rho, rng))
        found = intervals_of(parameters, fit, beyond_curvature(fit, recording))
        held += [each.low <= 0.5 <= each.high for each in found.values()]
        if rho:
            narrow = intervals_of(parameters, fit)["offset"]
            assert narrow.high - narrow.low < found["offset"].high - found["offset"].low
    assert 0.91 <= np.mean(held) <= 0.985
    assert NORMAL == pytest.approx(1.96, abs=0.001)


def test_samples_that_do_not_count_change_nothing(recording):
    """Residuals and slopes are zero where a sample does not count, and blocks are of those that do."""
    rng = np.random.default_rng(7)
    fit = fitted(coloured(0.9, rng))
    [whole] = recording
    padded = [
        SimpleNamespace(
            channels=(None,),
            time=np.arange(2 * SAMPLES) * 0.01,
            used=np.repeat([True, False], SAMPLES),
        )
    ]
    zeros = np.zeros(SAMPLES)
    longer = Fit(
        fit.unit,
        np.concatenate([fit.residuals, zeros]),
        fit.off_prior,
        np.concatenate([fit.jacobian, np.zeros((SAMPLES, 2))]),
        fit.prior_jacobian,
        fit.counted,
        1,
    )
    assert_allclose(beyond_curvature(longer, padded), beyond_curvature(fit, [whole]), rtol=1e-9)
