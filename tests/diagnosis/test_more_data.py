"""When parts of both recordings are fitted, and when a law is tried before that."""

from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.again import by_more_data
from hydrolek_drake.diagnosis.attempt import law_first, predicting

pytestmark = pytest.mark.long("the rules' inner steps; practice pairs run them from end to end")


class _AskedError(Exception):
    pass


def _known(verdict: str, fitted: float, ahead: float, nominal: float) -> SimpleNamespace:
    """What leaves so many times the noise of training and held-out data, and the nominal model of the former."""

    def said(*_):
        raise _AskedError

    best = SimpleNamespace(
        over_noise=ahead, hypothesis=SimpleNamespace(fit=SimpleNamespace(over_noise=fitted))
    )
    baseline = SimpleNamespace(fit=SimpleNamespace(over_noise=nominal))
    conclusion = SimpleNamespace(verdict=verdict, best=best)
    found = SimpleNamespace(baseline=baseline)
    return SimpleNamespace(conclusion=conclusion, found=found, say=said)


@pytest.mark.parametrize(
    ("verdict", "fitted", "ahead", "more"),
    [
        ("missing_physics", 1.0, 1.15, False),  # the bench asks for 1.2 of a model that is right
        ("missing_physics", 1.0, 1.25, True),
        ("none", 1.01, 1.25, True),
        ("unlisted_physics", 1.05, 1.6, True),
        ("unlisted_physics", 1.6, 2.0, False),  # the training data show it too
        ("unlisted_physics", 1.6, 4.0, True),
    ],
)
def test_a_model_that_fails_ahead_is_asked_with_more_data(verdict, fitted, ahead, more) -> None:
    known = _known(verdict, fitted, ahead, fitted)
    if more:
        with pytest.raises(_AskedError):
            by_more_data(known, (), known.say)
    else:
        assert by_more_data(known, (), known.say) is None


@pytest.mark.parametrize(
    ("known", "first"),
    [
        (_known("unlisted_physics", 1.1, 2.5, 4.0), True),  # effects imitate it in the training data
        (_known("unlisted_physics", 1.6, 4.0, 4.0), True),
        (_known("unlisted_physics", 1.02, 2.5, 1.03), False),  # only the held-out data show it
        (_known("unlisted_physics", 1.6, 2.0, 4.0), False),  # no more data are asked for
        (_known("missing_physics", 1.0, 1.25, 4.0), False),
    ],
)
def test_a_law_comes_first_where_the_training_data_ask_for_something(known, first: bool) -> None:
    assert law_first(known) is first


@pytest.mark.parametrize(
    ("fitted", "ahead", "predicts"), [(1.1, 1.15, True), (1.2, 1.1, False), (1.05, 1.3, False)]
)
def test_a_law_predicts_as_a_right_model_does(fitted: float, ahead: float, predicts: bool) -> None:
    law = SimpleNamespace(fit=SimpleNamespace(over_noise=fitted), held_out_over_noise=ahead)
    assert predicting(law) is predicts
