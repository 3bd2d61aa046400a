"""When a law for physics in no list is named, and beside which model."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_choice
from hydrolek_drake.diagnosis.conclusion import EXPLAINED, EXPLAINED_AHEAD, SURE, Conclusion
from hydrolek_drake.diagnosis.effort import AT_NOISE, MORE_AHEAD
from hydrolek_drake.diagnosis.gains import GAIN_NEEDED
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_choice import MANY, SIMPLER, with_law

VALUES = 1000
HELD_OUT = (SimpleNamespace(counted=VALUES),)


def _judged(over_noise: float, effects: int = 0, probability: float = 1.0) -> Judged:
    fit = SimpleNamespace(over_noise=over_noise, objective=VALUES * over_noise**2, counted=VALUES, unsure=0.0)
    hypothesis = SimpleNamespace(effects=tuple(range(effects)), fit=fit, ids=frozenset(range(effects)))
    return Judged(hypothesis, np.full(VALUES, over_noise), VALUES, probability=probability)


def _law(train: float, ahead: float, rivals: tuple[str, ...] = ()):
    fit = SimpleNamespace(over_noise=train, objective=VALUES * train**2)
    law = SimpleNamespace(input=SimpleNamespace(stage="load"))
    return SimpleNamespace(law=law, fit=fit, held_out_over_noise=ahead, rivals=rivals)


@pytest.fixture
def choose(monkeypatch):
    """(best known, nominal, law beside best, law alone, verdict) -> conclusion, law, what laws were sought beside.

    `without` is the law beside the best model when it is fitted without that one's effects.
    """

    def run(best, nominal, beside, alone, verdict="unlisted_physics", without=None, at_an_end=()):
        asked = []

        def find(bench, named, held_out, scales):
            asked.append(named)
            return alone if named is nominal else beside

        monkeypatch.setattr(law_choice, "find_law", find)
        monkeypatch.setattr(law_choice, "ended", lambda hypothesis, effect: at_an_end)
        monkeypatch.setattr(law_choice, "without_effects", lambda *given: without)
        known = Conclusion(verdict, best, {}, ())
        return *with_law(None, known, (best, nominal), HELD_OUT, None, lambda text: None), asked

    return run


def test_a_law_that_explains_all_alone_is_not_sought_beside_known_effects(choose) -> None:
    best, nominal = _judged(2.0, effects=1), _judged(10.0)
    alone = _law(EXPLAINED, EXPLAINED_AHEAD)
    conclusion, law, asked = choose(best, nominal, None, alone)
    assert law is alone and conclusion.best is nominal and asked == [nominal]


def test_stages_that_the_data_cannot_tell_apart_are_told(choose) -> None:
    """As the rod and the load of a vane, whose lever is constant."""
    best, nominal = _judged(2.0, effects=1), _judged(10.0)
    conclusion, _, _ = choose(best, nominal, None, _law(1.0, 1.0, rivals=("cylinder",)))
    assert conclusion.groups == (("unlisted.load", "unlisted.cylinder"),)
    conclusion, _, _ = choose(best, nominal, None, _law(1.0, 1.0))
    assert conclusion.groups == ()


def test_known_effects_stay_if_the_law_needs_them(choose) -> None:
    best, nominal = _judged(4.0, effects=1), _judged(10.0)
    beside = _law(1.5, 2.0)
    far = _law(3.0, 2.0 * SIMPLER * 1.01)
    conclusion, law, _ = choose(best, nominal, beside, far)
    assert law is beside and conclusion.best is best
    near = _law(3.0, 2.0 * SIMPLER * 0.99)
    conclusion, law, _ = choose(best, nominal, beside, near)
    assert law is near and conclusion.best is nominal


def test_a_law_found_beside_effects_is_preferred_without_them_if_it_does_as_well(choose) -> None:
    best, nominal = _judged(4.0, effects=2), _judged(10.0)
    beside, another = _law(1.0, 1.0), _law(3.0, 3.0)
    as_good, worse = _law(1.0, SIMPLER * 0.99), _law(1.0, SIMPLER * 1.01)
    conclusion, law, _ = choose(best, nominal, beside, another, without=as_good)
    assert law is as_good and conclusion.best is nominal
    conclusion, law, _ = choose(best, nominal, beside, None, without=as_good)
    assert law is as_good and conclusion.best is nominal
    conclusion, law, _ = choose(best, nominal, beside, another, without=worse)
    assert law is beside and conclusion.best is best


def test_effects_that_take_no_material_part_are_left_out(choose) -> None:
    best, nominal = _judged(9.0, effects=1), _judged(10.0)
    conclusion, law, asked = choose(best, nominal, _law(1.0, 1.0), None)
    assert law is None and conclusion.best is nominal and asked == [nominal]


def test_one_law_that_predicts_as_well_is_preferred_to_many_effects(choose) -> None:
    best, nominal = _judged(1.1, effects=MANY), _judged(10.0)
    as_good, worse = _law(1.0, 1.1), _law(1.0, 1.2)
    conclusion, law, _ = choose(best, nominal, None, as_good, verdict="missing_physics")
    assert law is as_good and conclusion.verdict == "unlisted_physics" and conclusion.best is nominal
    conclusion, law, _ = choose(best, nominal, None, worse, verdict="missing_physics")
    assert law is None and conclusion.verdict == "missing_physics" and conclusion.best is best
    lacking = replace(_judged(1.0, MANY - 1), held_out=np.full(VALUES, 1.01 * MORE_AHEAD))
    for doubtful in (_judged(1.0, MANY - 1, 0.99 * SURE), _judged(1.01 * AT_NOISE, MANY - 1), lacking):
        conclusion, law, _ = choose(doubtful, nominal, None, _law(1.0, 1.0), verdict="missing_physics")
        assert law is not None and conclusion.best is nominal
    fewer = _judged(1.0, MANY - 1)
    conclusion, law, asked = choose(fewer, nominal, None, as_good, verdict="missing_physics")
    assert law is None and conclusion.best is fewer and not asked


def test_one_effect_that_leaves_more_than_noise_ahead_must_stand_against_a_law(choose) -> None:
    nominal, off = (
        _judged(10.0),
        replace(_judged(1.0, effects=1), held_out=np.full(VALUES, 1.01 * MORE_AHEAD)),
    )
    ahead = float(off.held_out @ off.held_out)

    def leaving(less: float):
        """A law that leaves so much less of the held-out data."""
        return _law(1.0, np.sqrt((ahead - less) / VALUES))

    conclusion, law, _ = choose(off, nominal, None, leaving(1.01 * GAIN_NEEDED), verdict="missing_physics")
    assert law is not None and conclusion.verdict == "unlisted_physics" and conclusion.best is nominal
    conclusion, law, _ = choose(off, nominal, None, leaving(0.99 * GAIN_NEEDED), verdict="missing_physics")
    assert law is None and conclusion.best is off
    accounted = replace(off, chi_squared=0.9 * VALUES)  # numbers that are bent are uncertain too
    conclusion, law, _ = choose(accounted, nominal, None, leaving(ahead), verdict="missing_physics")
    assert law is not None and conclusion.best is nominal
    near = replace(off, held_out=np.full(VALUES, 0.99 * MORE_AHEAD))
    for best in (near, replace(off, hypothesis=nominal.hypothesis)):  # or nothing is named
        assert not choose(best, nominal, None, leaving(ahead), verdict="missing_physics")[2]


def test_an_effect_whose_numbers_end_where_it_does_must_stand_against_a_law(choose) -> None:
    nominal, best = _judged(10.0), _judged(1.0, effects=1)
    told = {"verdict": "missing_physics", "at_an_end": ("a time constant",)}
    better = _law(1.0, np.sqrt(1.0 - 1.01 * GAIN_NEEDED / VALUES))
    conclusion, law, _ = choose(best, nominal, None, better, **told)
    assert law is better and conclusion.verdict == "unlisted_physics"
    conclusion, law, _ = choose(best, nominal, None, _law(1.0, 1.0), **told)
    assert law is None and conclusion.best is best
    assert not choose(best, nominal, None, better, verdict="missing_physics")[2]
