"""e^x and tanh x in plain arithmetic are the library's, to rounding."""

import math

import numpy as np
import pytest

from hydrolek_drake.physics.smooth import exponential, hyperbolic_tangent, logarithm


def test_exponential_is_the_library_s_over_its_whole_range():
    x = np.concatenate([np.random.default_rng(1).uniform(-700.0, 700.0, 20000), np.linspace(-1.0, 1.0, 2001)])
    found = np.array([exponential(value) for value in x])
    np.testing.assert_allclose(found, np.exp(x), rtol=1e-15)
    assert exponential(0.0) == 1.0


@pytest.mark.parametrize("x", [-1e9, -math.inf, -701.0])
def test_far_below_it_is_nothing(x):
    assert 0.0 < exponential(x) < 1e-303


def test_logarithm_is_the_library_s():
    x = np.exp(np.random.default_rng(3).uniform(-600.0, 600.0, 20000))
    x = np.concatenate([x, np.linspace(0.5, 2.0, 2001)])
    found = np.array([logarithm(value) for value in x])
    np.testing.assert_allclose(found, np.log(x), rtol=1e-15, atol=1e-15)
    assert logarithm(1.0) == 0.0


def test_hyperbolic_tangent_is_the_library_s():
    x = np.concatenate([np.random.default_rng(2).uniform(-30.0, 30.0, 20000), np.linspace(-1e-3, 1e-3, 2001)])
    found = np.array([hyperbolic_tangent(value) for value in x])
    np.testing.assert_allclose(found, np.tanh(x), rtol=0.0, atol=3e-16)
    np.testing.assert_array_equal(found, -np.array([hyperbolic_tangent(-value) for value in x]))
    assert hyperbolic_tangent(1e300) == 1.0 and math.isnan(hyperbolic_tangent(math.nan))
