"""What is told is the posterior among the models tried, as far as such names have been right."""

from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.report.reliability import kind_of, reliability, reliability_data
from hydrolek_drake.diagnosis.settings import NOISE

ROUNDING = 1e-12  # where all were right, or none, the bound is met with equality
LEAK, AIR = "joints.j.effects.leak.size", "joints.j.effects.air.size"


def _judged(ids, over_noise):
    return SimpleNamespace(
        hypothesis=SimpleNamespace(ids=frozenset(ids), fit=SimpleNamespace(over_noise=over_noise))
    )


def _diagnosis(verdict, *judged):
    return SimpleNamespace(verdict=verdict, best=judged[0], judged=judged)


def test_a_share_never_reaches_one_or_zero_and_follows_the_count():
    for kind, counted in reliability_data().items():
        share = counted["right"] / counted["of"]
        assert 0.0 < reliability(kind) < 1.0
        assert abs(reliability(kind) - share) <= 0.5 / (counted["of"] + 1) + ROUNDING
        assert 0 <= counted["right"] <= counted["of"]


def test_an_effect_without_which_the_noise_is_left_too_is_hardly_needed():
    both, alone = _judged((LEAK, AIR), 1.0), _judged((LEAK,), 1.0 + 0.9 * NOISE.known)
    found = _diagnosis("missing_physics", both, alone, _judged((), 40.0))
    assert kind_of(found, AIR) == "hardly_needed"
    assert kind_of(found, LEAK) == "needed"


@pytest.mark.parametrize(("share", "kind"), [(0.9, "hardly_needed"), (1.1, "needed")])
def test_the_boundary_is_what_the_noise_is_uncertain_by(share, kind):
    found = _diagnosis(
        "missing_physics", _judged((LEAK,), 2.0), _judged((), 2.0 * (1.0 + share * NOISE.known))
    )
    assert kind_of(found, LEAK) == kind


def test_beside_unknown_physics_names_are_trusted_least():
    found = _diagnosis("unlisted_physics", _judged((LEAK,), 2.0), _judged((), 40.0))
    assert kind_of(found, LEAK) == "beside_unknown"
    assert reliability("beside_unknown") < reliability("law") < reliability("needed")
    hardly = _diagnosis("unlisted_physics", _judged((LEAK,), 2.0), _judged((), 2.0))
    assert kind_of(hardly, LEAK) == "hardly_needed"
