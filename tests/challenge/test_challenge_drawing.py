"""Cases are drawn alike from a seed, each conceals what can be told apart, and every size fits its machine."""

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.challenge.build import ARM_JOINTS, BENCH, build_of, rig_names
from hydrolek_drake.challenge.cases import TRAIN_S, labels_of, record
from hydrolek_drake.challenge.concealed import Concealed
from hydrolek_drake.challenge.drawing import FRICTIONS, _in_turn, _shown, drafted, draw_cases
from hydrolek_drake.challenge.listed import with_effects
from hydrolek_drake.cli.diagnosis.challenge import challenge
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.rigs import load_rig


def test_every_effect_has_its_turn() -> None:
    turn = _in_turn(["a", "b", "c"], np.random.default_rng(1))
    first = [next(turn) for _ in range(6)]
    assert sorted(first[:3]) == sorted(first[3:]) == ["a", "b", "c"]


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
