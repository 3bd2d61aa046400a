"""Cases are drawn alike from a seed, labels are hashed, and scores count what they say."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.challenge.build import ARM_JOINTS, BENCH, build_of, rig_names
from hydrolek_drake.challenge.calibration import calibration_png
from hydrolek_drake.challenge.cases import TRAIN_S, digest, labels_of, read_case, record
from hydrolek_drake.challenge.concealed import Concealed
from hydrolek_drake.challenge.confusion import confusion_markdown, confusions
from hydrolek_drake.challenge.drawing import FRICTIONS, _in_turn, _shown, drafted, draw_cases
from hydrolek_drake.challenge.listed import with_effects
from hydrolek_drake.challenge.scoring import markdown, score, summaries, summaries_markdown, summary
from hydrolek_drake.challenge.visibility import visibility_markdown
from hydrolek_drake.cli.diagnosis.challenge import challenge
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig


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


def test_every_effect_has_its_turn() -> None:
    turn = _in_turn(["a", "b", "c"], np.random.default_rng(1))
    first = [next(turn) for _ in range(6)]
    assert sorted(first[:3]) == sorted(first[3:]) == ["a", "b", "c"]


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


def test_a_choice_of_rigs_is_one_or_a_group() -> None:
    assert rig_names("hydrolek_right_j4") == ("hydrolek_right_j4",)
    assert set(rig_names("all")) == {BENCH, *ARM_JOINTS}
    with pytest.raises(InputError, match="--rig emps"):
        rig_names("emps")


@pytest.mark.parametrize("name", [BENCH, *ARM_JOINTS])
def test_every_size_fits_its_machine(name: str) -> None:
    build = build_of(load_rig(name, {}))
    fields = set(build.nominal.concealed._fields)
    for effect, entry in build.listed.items():
        assert with_effects(
            build.nominal, {effect: entry["size"] | dict.fromkeys(entry.get("draw", {}), 1.0)}
        )
    for entry in build.unlisted.values():
        assert {*entry["size"], *entry.get("draw", {})} <= fields
        assert "stage" in entry


def test_an_old_label_is_a_case_of_the_bench() -> None:
    label = _case("healthy") | {"machine": {}, "seed": 1}
    assert read_case(label).rig == BENCH


def test_cases_of_joints_are_drawn_alike_and_recorded_with_their_noise(tmp_path) -> None:
    rigs = [load_rig(name, {}) for name in ("hydrolek_left_j3", "hydrolek_right_j5")]
    # the first kind of all is healthy, which needs no size and so no time
    cases = [case for seed in (1, 2) for case in draw_cases(rigs, 1, seed)]
    assert labels_of(cases[:1]) == labels_of(draw_cases(rigs, 1, 1))
    assert {case.kind for case in cases} == {"healthy"}
    case = cases[0]
    rig = next(rig for rig in rigs if rig.name == case.rig)
    record(rig, case, tmp_path)
    angle = read_recording(tmp_path / "train.csv", rig.columns).signal(f"{rig.joints[0]}.angle")
    noise = rig.value("sensor.noise")
    rest = np.asarray(angle)[:50] - rig.value(
        "load.initial_position"
    )  # nothing moves in the first half second
    # 50 samples know their deviation to 10 %; three times that, and the resolution's rounding
    assert noise * 0.7 < np.sqrt(np.mean(rest**2)) < noise * 1.35


def test_a_drawing_goes_on_where_it_ended(tmp_path) -> None:
    rigs = [load_rig(BENCH, {})]
    told: list[str] = []
    healthy = (("healthy", 1.0),)
    with ThreadPoolExecutor(2) as pool:
        labels = labels_of(draw_cases(rigs, 4, 5, healthy, tmp_path, pool, told.append))
    assert labels == labels_of(draw_cases(rigs, 4, 5, healthy))  # one after the other they are the same
    assert len(told) == 4 and "machine 4 of 4" in told[-1]
    kept = tmp_path / "case_002.json"
    kept.write_text(json.dumps(json.loads(kept.read_text()) | {"seed": 77}))  # to be seen again
    (tmp_path / "case_003.json").unlink()
    again = draw_cases(rigs, 4, 5, healthy, tmp_path)
    assert again[1].seed == 77
    assert labels_of([again[2]]) == labels_of(draw_cases(rigs, 4, 5, healthy)[2:3])


@pytest.mark.long("a fifth of a minute")
def test_what_an_effect_shows_is_counted_beside_the_others() -> None:
    build = build_of(load_rig(BENCH, {}))
    drift = {"sensor.drift": {"rate_rad_per_min": 0.02}}
    still = {"fluid.entrained_air": {"air_fraction": 0.0}}
    alone = _shown(build, build.nominal, drift, "open", 3)
    # a drift of the reading is r t, whose root mean square over T is r T / sqrt(3), whatever else the machine has
    expected = 0.02 / 60.0 * TRAIN_S / np.sqrt(3.0) / build.noise
    assert alone["sensor.drift"] == pytest.approx(expected, rel=1e-3)
    beside = _shown(build, build.nominal, drift | still, "open", 3)
    assert beside == {"sensor.drift": pytest.approx(expected, rel=1e-3), "fluid.entrained_air": 0.0}
    cushion = {"cylinder.end_cushion": {"damping_N_s_per_m": 2e4, "length_m": 0.05}}
    late = {"command.delay": {"delay_s": 2.0 * TRAIN_S}}  # no command arrives, so that no cushion is reached
    assert _shown(build, build.nominal, cushion, "open", 3)["cylinder.end_cushion"] > 1.0
    assert _shown(build, build.nominal, cushion | late, "open", 3)["cylinder.end_cushion"] == 0.0


def test_friction_where_the_bore_is_scored_acts_there_alone() -> None:
    build = build_of(load_rig(BENCH, {}))
    scored = Concealed(rubbing_n=1500.0, rubbing_at=0.6, rubbing_wide=0.1)
    reached = build.nominal._replace(concealed=scored)
    elsewhere = build.nominal._replace(
        concealed=scored._replace(rubbing_at=3.0)
    )  # farther than the rod comes
    volts = np.r_[np.zeros(50), np.full(350, 3.0), np.full(400, -3.0)]
    plain = build.play(build.nominal, volts).reading
    assert np.array_equal(build.play(elsewhere, volts).reading, plain)
    assert np.max(np.abs(build.play(reached, volts).reading - plain)) > 10.0 * build.noise


def test_every_double_conceals_two_different_effects_that_can_be_told_apart() -> None:
    full = build_of(load_rig("joint_bench"))
    few = replace(full, listed={name: full.listed[name] for name in (*sorted(FRICTIONS), "base.compliance")})
    for seed in range(20):  # of so few, one that was drawn just now often comes again
        builds = [full, few][seed % 2 :]
        drafts = drafted(builds, 60, np.random.default_rng(seed), np.random.default_rng((seed, 2)))
        assert len(drafts) == 60
        for build, kind, _level, names, unlisted in drafts:
            assert (len(names), len(unlisted)) == {
                "single": (1, 0),
                "double": (2, 0),
                "unlisted": (0, 1),
            }.get(kind, (0, 0))
            assert len(set(names)) == len(names)
            assert not set(names) >= FRICTIONS
            assert set(names) <= set(build.listed)


def test_cases_of_one_kind_conceal_every_kind_of_physics_as_often() -> None:
    builds = [build_of(load_rig(name, {})) for name in (BENCH, "hydrolek_left_j3")]
    count = 2 * len(builds[0].unlisted)
    rngs = (np.random.default_rng(7), np.random.default_rng(8))
    drafts = drafted(builds, count, *rngs, shares=(("unlisted", 1.0),))
    assert {kind for _, kind, *_ in drafts} == {"unlisted"}
    drawn = [name for *_, (name,) in drafts]
    assert sorted(drawn) == sorted(2 * list(builds[0].unlisted))
    for build, *_, (name,) in drafts:  # each machine has a number for every parameter
        entry = build.unlisted[name]
        assert set(build.nominal.concealed._fields) >= {*entry["size"], *entry.get("draw", {})}


def test_a_kind_that_is_not_drawn_is_refused_in_one_line(tmp_path) -> None:
    with pytest.raises(InputError, match=r"--kind triple: no such cases; choose healthy, single, double"):
        challenge(kind="triple", out=tmp_path / "cases")
    assert not (tmp_path / "cases").exists()
