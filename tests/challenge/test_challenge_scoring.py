"""Labels are hashed, and scores count what they say."""

import json

import pytest

from hydrolek_drake.challenge.build import BENCH
from hydrolek_drake.challenge.calibration import calibration_png
from hydrolek_drake.challenge.cases import digest, read_case
from hydrolek_drake.challenge.confusion import confusion_markdown, confusions
from hydrolek_drake.challenge.scoring import markdown, score, summaries, summaries_markdown, summary
from hydrolek_drake.challenge.visibility import visibility_markdown


def _report(verdict, effects=(), stages=(), groups=(), probability=0.99, low=0.9):
    known = {"value": 1.1, "low": low, "high": 1.3}
    return {
        "verdict": verdict,
        "effects": [{"id": e, "probability": probability, "parameters": {"a": known}} for e in effects],
        "locations": [{"stage": s} for s in stages],
        "not_distinguishable": [list(g) for g in groups],
        "fit": {"baseline": {"train_over_noise": 5.0}, "with_effects": {"holdout_over_noise": 1.0}},
        "seconds": 20.0,
    }


def _case(kind, effects=(), stages=(), size="large", unlisted=(), **more):
    return {
        "name": "case", "kind": kind, "size": size, "drive": "open", "pressures": False,
        "effects": {e: {"a": 1.0} for e in effects}, "unlisted": {u: {} for u in unlisted}, "stages": list(stages),
        **more,
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


def test_intervals_are_counted_that_hold_the_true_value() -> None:
    case = _case("single", ["a.x"], ["a"])
    results = [score(case, _report("missing_physics", ["a.x"], ["a"], low=low)) for low in (0.9, 1.05, 1.0)]
    assert summary(results)["intervals_that_hold"] == {"count": 2, "of": 3, "share": pytest.approx(2 / 3)}


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


def test_each_group_of_rigs_counts_its_own() -> None:
    bench = score(_case("healthy"), _report("none"))  # an old label, which names no rig
    arm = score(_case("healthy", rig="hydrolek_left_j3"), _report("missing_physics", ["x.y"], ["x"]))
    told = summaries([bench, arm])
    assert told["all"]["false_alarms"]["of"] == 2
    assert told["bench"]["false_alarms"]["count"] == 0
    assert told["arms"]["false_alarms"] == told["hydrolek_left_j3"]["false_alarms"]
    assert "| false alarms | 1 of 2 | 0 of 1 | 1 of 1 | 1 of 1 |" in summaries_markdown(told)


def test_an_effect_that_its_machine_hardly_shows_counts_as_barely_visible() -> None:
    report = _report("none")
    hidden = score(_case("single", ["a.x"], ["a"], shows={"a.x": 0.4}), report)
    plain = score(_case("single", ["a.x"], ["a"], shows={"a.x": 28.0}), report)
    told = summary([hidden, plain])
    assert told["visible_singles_right"]["of"] == told["barely_visible_singles_right"]["of"] == 1


def test_what_a_refitted_nominal_model_explains_is_counted_apart() -> None:
    """A droop that a valve which opens a little less stands for leaves nothing in the data."""
    case = _case("single", {"supply.pressure_droop": {}}, ["supply"], shows={"supply.pressure_droop": 6.0})
    results = []
    for train, held_out in ((0.99, 1.02), (1.01, 1.05), (2.0, 0.99)):
        report = _report("none")
        report["fit"]["baseline"] = {"train_over_noise": train, "holdout_over_noise": held_out}
        results.append(score(case, report))
    told = summary(results)
    assert told["visible_singles_right"]["of"] == 3
    assert told["visible_singles_beyond_a_refit_right"] == {"count": 0, "of": 2, "share": 0.0}


def test_confusion_has_the_right_ones_on_its_diagonal() -> None:
    told = confusions(
        [
            score(_case("healthy"), _report("none")),
            score(
                _case("double", ["a.x", "b.y"], ["a", "b"]), _report("missing_physics", ["a.x", "c.z"], ["a", "c"])
            ),
            score(_case("single", ["b.y"], ["b"]), _report("none")),
            score(
                _case("unlisted", stages=["supply"], unlisted=["supply.ripple"]),
                _report("unlisted_physics", ["unlisted.load"], ["load"]),
            ),
        ]
    )  # fmt: skip
    assert told == {
        ("nothing", "nothing"): 1,
        ("a.x", "a.x"): 1,
        ("b.y", "c.z"): 1,
        ("b.y", "nothing"): 1,
        ("unlisted: supply.ripple", "unlisted at load"): 1,
    }


def test_confusion_table_has_a_row_for_each_thing_concealed() -> None:
    missed = score(_case("single", ["b.y"], ["b"]), _report("none"))
    alarmed = score(_case("healthy"), _report("missing_physics", ["b.y"], ["b"]))
    lines = confusion_markdown([missed, alarmed]).splitlines()
    assert lines[0] == "| concealed \\ named | nothing | b.y |"
    assert lines[2:] == ["| nothing |  | 1 |", "| b.y | 1 |  |"]


def test_visibility_parts_found_from_missed_sizes() -> None:
    def one(shown, named):
        report = _report("missing_physics" if named else "none", ["a.x"] if named else [], ["a"])
        return score(_case("single", ["a.x"], ["a"], shows={"a.x": shown}), report)

    table = visibility_markdown([one(6.2, True), one(1.4, False), one(29.0, True)])
    assert "| a.x | 6.2, 29 | 1.4 | 6.2 | 1.4 |" in table
    old = score(_case("single", ["a.x"], ["a"], size="middle"), _report("none"))  # tells what was wanted only
    assert "| a.x |  | 6 |  | 6 |" in visibility_markdown([old])


def test_calibration_picture_is_drawn_even_of_nothing() -> None:
    for results in ([], [score(_case("single", ["a.x"], ["a"]), _report("missing_physics", ["a.x"], ["a"]))]):
        assert calibration_png(summary(results)["calibration"]).startswith(b"\x89PNG")


def test_an_old_label_is_a_case_of_the_bench() -> None:
    label = _case("healthy") | {"machine": {}, "seed": 1}
    assert read_case(label).rig == BENCH
