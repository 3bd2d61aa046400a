"""Terms of a law that promise something alone, or only together."""

from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis.law_growing import only_difference
from hydrolek_drake.diagnosis.law_terms import TRIED, Promise, gain_along, only_together
from hydrolek_drake.diagnosis.laws import Term
from hydrolek_drake.diagnosis.unlisted import predicts_alike

CONSTANT, PILOT, SPEED = Term(()), Term((), other="p_B"), Term((), speed="v")
SHUT, OPENS = -0.3, 0.4
"""Share of a way out that is shut, and by how much it opens with the pilot pressure, in scales of the input."""


def _alone(columns, rest) -> list[Promise]:
    told = [gain_along(column[:, None], rest) for column in columns]
    terms = (CONSTANT, PILOT, SPEED)
    return [Promise((t,), gain, starts) for t, (gain, starts) in zip(terms, told, strict=True)]


@pytest.mark.parametrize(("kept_within", "together"), [(0.02, True), (1.0, False)])
def test_what_a_nearly_steady_pressure_opens_is_found_by_two_terms_at_once(kept_within, together) -> None:
    """The pressure stays near -SHUT / OPENS of its scale: what is shut and what is opened cancel but for little."""
    rng = np.random.default_rng(1)
    flow = rng.standard_normal(2000)
    pressure = -SHUT / OPENS + kept_within * rng.standard_normal(flow.size)
    columns = [TRIED * 1e3 * each for each in (flow, flow * pressure, rng.standard_normal(flow.size))]
    rest = -(SHUT * columns[0] + OPENS * columns[1]) / TRIED
    found = only_together(_alone(columns, rest), columns, rest)
    assert bool(found) is together
    if together:
        assert found[0].terms == (CONSTANT, PILOT)
        assert found[0].starts == pytest.approx((SHUT, OPENS))
        assert found[0].gain == pytest.approx(rest @ rest)


def test_nothing_is_paired_where_a_constant_has_no_meaning_or_one_term_does_it_all() -> None:
    rng = np.random.default_rng(2)
    columns = [rng.standard_normal(500) for _ in range(3)]
    rest = -columns[1] / TRIED
    alone = _alone(columns, rest)
    assert only_together(alone, columns, rest) == []
    assert only_together(alone[1:], columns[1:], columns[0]) == []


def test_a_law_of_one_pressure_grows_by_the_other_and_not_by_their_difference() -> None:
    """Both say the same, and the engineer who knows the valve reads p_A and p_B."""
    difference = Term((), other="(p_A - p_B)")
    assert only_difference(difference, (CONSTANT, PILOT))
    assert not only_difference(difference, (CONSTANT,))
    assert not only_difference(Term((), other="p_A"), (CONSTANT, PILOT))


@pytest.mark.parametrize(
    ("fitted", "ahead", "periodic", "alike"),
    [
        (1.5, 1.05, False, True),  # predicts as the best one does
        (1.0, 1.6, False, True),  # explains the training data and went astray: other numbers may follow both
        (1.5, 1.6, False, False),
        (1.0, 2.5, False, False),
        (1.0, 1.6, True, False),  # a phase is fitted to each recording as it is
    ],
)
def test_laws_that_went_astray_are_held_against_all_data(fitted, ahead, periodic, alike) -> None:
    law = SimpleNamespace(
        fit=SimpleNamespace(over_noise=fitted),
        held_out_over_noise=ahead,
        law=SimpleNamespace(periodic=periodic),
    )
    assert predicts_alike(law, least=1.0) is alike
