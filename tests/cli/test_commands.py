"""What the commands print and write."""

import json
from pathlib import Path

import pytest

from hydrolek_drake.effects.catalogue import EFFECTS
from hydrolek_drake.rigs import built_in_rigs, load_rig

BENCH = Path(__file__).parents[2] / "tests" / "data" / "bench"


def test_replay_says_how_far_when_and_where(printed, tmp_path):
    text = printed("replay", "joint_bench", BENCH / "practice_03" / "train.csv", "--out", tmp_path / "out")
    numbers = json.loads((tmp_path / "out" / "replay.json").read_text())
    assert all(signal["sentence"] in text for signal in numbers["signals"])
    first = numbers["signals"][0]["worst_spans"][0]
    assert f"{first['from_s']:.2f}-{first['to_s']:.2f} s" in text
    assert "replay.html" in text


def test_settings_and_window_reach_the_replay(printed, tmp_path):
    train = BENCH / "practice_01" / "train.csv"
    whole, part = tmp_path / "whole", tmp_path / "part"
    printed("replay", "joint_bench", train, "--out", whole)
    printed(
        "replay",
        "joint_bench",
        train,
        "--set",
        "supply.pressure=13 MPa",
        "--between",
        "0",
        "5",
        "--out",
        part,
    )
    a, b = (json.loads((folder / "replay.json").read_text()) for folder in (whole, part))
    assert (b["from_s"], b["to_s"]) == (0.0, 5.0)
    assert a["signals"][0]["rms"] != b["signals"][0]["rms"]


def test_several_recordings_have_folders_of_their_own(printed, tmp_path):
    files = [BENCH / name / "train.csv" for name in ("practice_01", "practice_03")]
    printed("replay", "joint_bench", *files, "--out", tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"practice_01_train", "practice_03_train"}
    assert all((path / "replay.html").is_file() for path in tmp_path.iterdir())


def test_effects_are_all_listed(printed):
    lines = printed("effects").splitlines()
    assert [line.split()[0] for line in lines[1:]] == sorted(EFFECTS)


@pytest.mark.parametrize("effect_id", sorted(EFFECTS))
def test_effect_in_full(printed, effect_id):
    effect = EFFECTS[effect_id]
    text = printed("effects", effect_id)
    assert effect.equation in text and effect.source in text
    assert all(f"{p.name} [{p.unit}]: {p.meaning}" in text for p in effect.parameters)
    assert all(other in text and how in text for other, how in effect.confused_with.items())


def test_rigs_are_all_listed(printed):
    text = printed("rigs")
    assert all(name in text for name in built_in_rigs())


def test_rig_shows_its_parameters(printed):
    text = printed("rigs", "joint_bench", "--set", "supply.pressure=12 MPa")
    rows = {line.split()[0]: line.split()[1:] for line in text.splitlines() if line.strip()}
    assert rows["supply.pressure"][:2] == ["1.2e+07", "Pa"]
    rig = load_rig("joint_bench")
    stated = [path for path, entry in rig.entries.items() if not entry.source.startswith("neutral:")]
    assert set(stated) <= set(rows)
