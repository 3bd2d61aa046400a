"""Every listed effect that a diagnosis names can be told, whichever of its numbers a rig lets be fitted."""

import json

import pytest

from hydrolek_drake.diagnosis.report.as_json import as_json
from hydrolek_drake.diagnosis.report.words import effect_sentence
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.effects import EFFECTS
from hydrolek_drake.identification.experiments.natural_scales import natural_scales

FADING = "fading_exponent"
BENCH, ELSEWHERE = "joint_bench", ("emps", "festo_tp511", "hopsan_link")
SECONDS = 3.0


@pytest.fixture(scope="module")
def every(named):
    """Effect -> rig, and sizes at which its search begins there, of the numbers that the rig lets be fitted."""
    found = {}
    for name in (*ELSEWHERE, BENCH):
        nothing = named(name, {}, SECONDS)
        rig, training = nothing.rig, nothing.bench.training
        for c in candidates_of(rig, rig.joints[0], natural_scales(rig, rig.joints[0], training)):
            found[c.id] = name, {path.rpartition(".")[2]: value for path, value in c.starts[0].items()}
    return found


@pytest.mark.parametrize("effect", sorted(EFFECTS))
def test_what_was_fitted_is_told_with_its_interval(effect: str, every, named) -> None:
    rig, planted = every[effect]
    diagnosis = named(rig, {effect: planted}, SECONDS)
    [told] = json.loads(json.dumps(as_json(diagnosis)))["effects"]
    assert told["id"] == effect
    assert told["sentence"] == effect_sentence(*diagnosis.best.hypothesis.effects, diagnosis)
    assert set(planted) <= set(told["parameters"]) <= {p.name for p in EFFECTS[effect].parameters}
    for name, value in planted.items():
        own = told["parameters"][name]
        assert own["value"] == pytest.approx(value) and own["low"] <= own["value"] <= own["high"]


def test_an_exponent_that_the_rig_fixes_is_not_told_as_if_it_had_been_fitted(every, named) -> None:
    stribeck = "cylinder.stribeck_friction"
    rig, planted = every[stribeck]
    assert rig == BENCH and FADING in {p.name for p in EFFECTS[stribeck].parameters}
    [told] = as_json(named(rig, {stribeck: planted}, SECONDS))["effects"]
    assert set(told["parameters"]) == set(planted) and FADING not in planted
