"""Equations (4.13), (4.14), (4.17), (4.18) on numbers that can be checked by hand."""

import math

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.objective.norms import mean_norm, relative_norm, segment_norms
from hydrolek_drake.identification.objective.output_error import OutputError

ERROR = np.array([3.0, -4.0, 0.0, 0.0])


@pytest.mark.parametrize(("p", "value"), [(1.0, 7.0 / 4.0), (2.0, 2.5), (math.inf, 4.0)])
def test_equation_4_13(p, value):
    assert mean_norm(ERROR, p) == pytest.approx(value)


@pytest.mark.parametrize(("p", "size"), [(1.0, 20.0), (2.0, 10.0), (math.inf, 5.0)])
def test_equation_4_14_is_4_13_over_the_norm_of_what_was_measured(p, size):
    measured = np.array([5.0, 5.0, -5.0, 5.0])
    assert relative_norm(ERROR, measured, p) == pytest.approx(mean_norm(ERROR, p) / size)


def test_equations_4_17_and_4_18_part_by_part():
    np.testing.assert_allclose(segment_norms(ERROR, 2, 2.0), [np.sqrt(12.5), 0.0])
    np.testing.assert_allclose(segment_norms(ERROR, 4, math.inf), [3.0, 4.0, 0.0, 0.0])
    whole = mean_norm(ERROR, 2.0)
    assert np.sqrt(np.mean(segment_norms(ERROR, 2, 2.0) ** 2)) == pytest.approx(whole)


def test_what_was_not_measured_does_not_count_and_a_divergence_is_nan():
    measured = np.array([1.0, np.nan, 3.0])
    objective = OutputError(lambda point: point[0] * np.ones(3), measured, p=1.0)
    assert objective(np.array([1.0])) == pytest.approx(2.0 / 3.0)
    assert np.isnan(OutputError(lambda point: np.full(3, np.nan), measured)(np.array([1.0]))).all()


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"p": 3.0}, "p is 3; choose 1, 2 or inf"),
        ({"segments": 4}, "4 segments of 3 samples"),
        ({"segments": 2, "relative": True}, "choose relative or segments"),
    ],
)
def test_an_objective_that_cannot_be_is_refused(changes, said):
    with pytest.raises(InputError, match=said):
        OutputError(lambda point: point, np.zeros(3), **changes)
