"""Cases are drawn alike from a seed, labels are hashed, and scores count what they say."""

import json

import pytest

from hydrolek_drake.challenge.cases import _in_turn, digest
from hydrolek_drake.challenge.scoring import markdown, score, summary


def _report(verdict, effects=(), stages=(), groups=(), probability=0.99):
    return {
        "verdict": verdict,
        "effects": [
            {"id": e, "probability": probability, "parameters": {"a": {"value": 1.1}}} for e in effects
        ],
        "locations": [{"stage": s} for s in stages],
        "not_distinguishable": [list(g) for g in groups],
        "fit": {"baseline": {"train_over_noise": 5.0}, "with_effects": {"holdout_over_noise": 1.0}},
        "seconds": 20.0,
    }


def _case(kind, effects=(), stages=(), size="large", unlisted=()):
    return {
        "name": "case", "kind": kind, "size": size, "drive": "open", "pressures": False,
        "effects": {e: {"a": 1.0} for e in effects}, "unlisted": {u: {} for u in unlisted}, "stages": list(stages),
    }  # fmt: skip


def test_a_healthy_machine_is_right_only_if_nothing_is_named() -> None:
    assert score(_case("healthy"), _report("none"))["right"]
    alarmed = score(_case("healthy"), _report("missing_physics", ["x.y"], ["x"]))
    assert not alarmed["right"]
    told = summary([alarmed, score(_case("healthy"), _report("none"))])
    assert told["false_alarms"] == {"count": 1, "of": 2, "share": 0.5}


def test_both_effects_of_a_double_must_be_named_and_no_third() -> None:
    case = _case("double", ["a.x", "b.y"], ["a", "b"])
    assert score(case, _report("missing_physics", ["a.x", "b.y"], ["a", "b"]))["right"]
    assert not score(case, _report("missing_physics", ["a.x"], ["a"]))["right"]
    assert not score(case, _report("missing_physics", ["a.x", "b.y", "c.z"], ["a", "b", "c"]))["right"]


def test_parameter_errors_are_relative() -> None:
    one = score(_case("single", ["a.x"], ["a"]), _report("missing_physics", ["a.x"], ["a"]))
    assert one["parameter_errors"] == pytest.approx([0.1])
    assert summary([one])["median_parameter_error"] == pytest.approx(0.1)


def test_unlisted_needs_its_verdict_and_its_stage_first() -> None:
    case = _case("unlisted", stages=["supply"], unlisted=["supply.ripple"])
    right = score(case, _report("unlisted_physics", ["unlisted.supply"], ["supply"]))
    assert right["right"] and right["right_stage"] and right["named"] == []
    assert not score(case, _report("missing_physics", ["a.x"], ["a"]))["right"]


def test_calibration_counts_the_right_ones_of_each_bin() -> None:
    good = score(
        _case("single", ["a.x"], ["a"]), _report("missing_physics", ["a.x"], ["a"], probability=0.95)
    )
    bad = score(_case("single", ["b.y"], ["b"]), _report("missing_physics", ["a.x"], ["a"], probability=0.95))
    told = next(b for b in summary([good, bad])["calibration"] if b["from"] == 0.9)
    assert (told["count"], told["of"]) == (1, 2)
    assert "NO" in markdown([good, bad]).splitlines()[2]  # failures come first


def test_the_hash_changes_with_any_label() -> None:
    labels = json.dumps([_case("healthy")])
    assert digest(labels) != digest(labels.replace("healthy", "healthx"))
    assert len(digest(labels)) == 64


def test_every_effect_has_its_turn() -> None:
    import numpy as np

    turn = _in_turn(["a", "b", "c"], np.random.default_rng(1))
    first = [next(turn) for _ in range(6)]
    assert sorted(first[:3]) == sorted(first[3:]) == ["a", "b", "c"]
