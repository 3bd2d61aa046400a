"""One line says what to look at on the machine, for every stage at which physics in no list may act."""

import re
from types import SimpleNamespace

import pytest

from hydrolek_drake.diagnosis.report.look_at import look_at, stage_sentences
from hydrolek_drake.diagnosis.structures.inputs import inputs_of
from hydrolek_drake.effects import EFFECTS

SCALES = SimpleNamespace(
    load_force=1.0,
    travel=1.0,
    travel_time=1.0,
    conductance=1.0,
    force=1.0,
    load_rubbing=0.0,
    rubbing=0.0,
    bit=0.0,
    capacity=1.0,
    opening=1.0,
    flow=1.0,
)
LEAK, FRICTION = EFFECTS["cylinder.cross_port_leakage"], EFFECTS["cylinder.coulomb_friction"]


def test_every_stage_of_a_law_has_its_sentence() -> None:
    stages = {each.stage for each in inputs_of(SCALES, 1e7, 10.0, "rad")}
    assert len(stages) > 5 and stages <= set(stage_sentences())
    assert all(re.fullmatch(r"[A-Z].{30,180}\.", text) for text in stage_sentences().values())


def _judged(over_noise: float, *paths: str) -> SimpleNamespace:
    return SimpleNamespace(over_noise=over_noise, hypothesis=SimpleNamespace(ids=frozenset(paths)))


def _diagnosis(verdict: str, law=None) -> SimpleNamespace:
    listed = [SimpleNamespace(effect=e, joint="j", size_path=e.id) for e in (FRICTION, LEAK)]
    best = SimpleNamespace(
        hypothesis=SimpleNamespace(listed=listed, ids=frozenset((FRICTION.id, LEAK.id))), over_noise=1.0
    )
    judged = (best, _judged(3.0, LEAK.id), _judged(40.0, FRICTION.id), _judged(60.0))
    conclusion = SimpleNamespace(probability={FRICTION.id: 1.0, LEAK.id: 1.0})
    return SimpleNamespace(verdict=verdict, conclusion=conclusion, law=law, best=best, judged=judged)


def test_of_two_effects_that_are_equally_probable_the_one_without_which_more_is_left_leads() -> None:
    assert look_at(_diagnosis("missing_physics")) == f"j, cylinder: {LEAK.inspect}"


@pytest.mark.parametrize("verdict", ["none", "bad_data"])
def test_where_nothing_is_missing_there_is_nothing_to_look_at(verdict) -> None:
    assert look_at(_diagnosis(verdict)) == ""


def test_a_law_leads_to_its_stage() -> None:
    law = SimpleNamespace(joint="j", law=SimpleNamespace(input=SimpleNamespace(stage="supply")))
    assert look_at(_diagnosis("unlisted_physics", law)) == f"j, supply: {stage_sentences()['supply']}"
