"""What a challenge wrote is read back where it goes on, and nothing else is."""

import json

import pytest

from hydrolek_drake.challenge.build import BENCH
from hydrolek_drake.challenge.cases import digest, labels_of
from hydrolek_drake.challenge.drawing import draw_cases
from hydrolek_drake.challenge.results import earlier_scores, write_results
from hydrolek_drake.cli.diagnosis.challenge import challenge
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig

SCORED = {
    "name": "case_001", "rig": "joint_bench", "kind": "healthy", "size": "", "drive": "open", "pressures": False,
    "truth": [], "verdict": "none", "named": [], "shows": {}, "stage": None, "probability": None, "seconds": 9.0,
    "holdout_over_noise": 1.0, "baseline_over_noise": 1.0, "baseline_holdout_over_noise": 1.0, "right": True,
    "right_stage": True,
}  # fmt: skip


def test_scores_are_read_back_as_they_were_written(tmp_path) -> None:
    told = write_results(tmp_path, "a" * 64, [SCORED])
    assert told["all"]["false_alarms"] == {"count": 0, "of": 1, "share": 0.0}
    assert earlier_scores(tmp_path / "summary.json", "a" * 64) == {"case_001": SCORED}
    for name in ("summary.md", "cases.md", "confusion.md", "visibility.md", "calibration.png"):
        assert (tmp_path / name).stat().st_size > 0


def test_results_of_no_case_yet_can_be_written(tmp_path) -> None:
    write_results(tmp_path, "a" * 64, [])  # interrupted during the first one
    assert earlier_scores(tmp_path / "summary.json", "a" * 64) == {}


def test_scores_of_other_labels_are_refused_in_one_line(tmp_path) -> None:
    write_results(tmp_path, "a" * 64, [SCORED])
    with pytest.raises(
        InputError, match=r"sha256 aaaaaaaaaaaa\.\.\., not bbbbbbbbbbbb\.\.\.; the same --rig"
    ):
        earlier_scores(tmp_path / "summary.json", "b" * 64)


NAMES_ALONE = json.dumps({"labels_sha256": "a" * 64, "cases": [{"name": "case_001"}]})


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", json.dumps({"labels_sha256": "a", "cases": [1]}), NAMES_ALONE, None]
)
def test_what_is_no_summary_is_refused_in_one_line(tmp_path, text: str | None) -> None:
    path = tmp_path / "summary.json"
    if text is not None:
        path.write_text(text)
    with pytest.raises(
        InputError, match=r"--earlier .*summary.json: (no summary|cannot be read: No such file)"
    ):
        earlier_scores(path, "a" * 64)


def test_what_was_scored_elsewhere_is_not_run_again(tmp_path) -> None:
    labels = labels_of(draw_cases([load_rig(BENCH, {})], 2, 3, (("healthy", 1.0),)))
    (tmp_path / "elsewhere").mkdir()
    scores = [SCORED, SCORED | {"name": "case_002", "seconds": 11.0}]
    write_results(tmp_path / "elsewhere", digest(labels), scores)
    out = tmp_path / "here"
    challenge(cases=2, seed=3, kind="healthy", earlier=tmp_path / "elsewhere" / "summary.json", out=out)
    told = json.loads((out / "summary.json").read_text())
    assert (told["labels_sha256"], told["cases"]) == (digest(labels), scores)
    assert not [path for path in out.iterdir() if path.is_dir()]  # no case, no machines half drawn


def test_an_interrupt_loses_no_score_of_an_earlier_run(tmp_path, monkeypatch) -> None:
    """Also where the earlier results are those that are written to."""
    labels = labels_of(draw_cases([load_rig(BENCH, {})], 2, 3, (("healthy", 1.0),)))
    second = SCORED | {"name": "case_002"}
    write_results(tmp_path, digest(labels), [second])

    def interrupted(*given, **named):
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrolek_drake.challenge.diagnosed.diagnose", interrupted)
    with pytest.raises(KeyboardInterrupt):
        challenge(cases=2, seed=3, kind="healthy", earlier=tmp_path / "summary.json", out=tmp_path)
    assert json.loads((tmp_path / "summary.json").read_text())["cases"] == [second]


@pytest.mark.long("two diagnoses on a cluster: minutes")
def test_cases_are_diagnosed_and_scored_over_a_cluster(cluster, tmp_path) -> None:
    address = cluster.scheduler_address
    challenge(cases=2, seed=3, kind="healthy", cluster=address, out=tmp_path)
    told = json.loads((tmp_path / "summary.json").read_text())
    labels = labels_of(draw_cases([load_rig(BENCH, {})], 2, 3, (("healthy", 1.0),)))
    assert told["labels_sha256"] == digest(labels)
    assert [case["name"] for case in told["cases"]] == ["case_001", "case_002"]
    assert all(case["verdict"] == "none" and case["right"] for case in told["cases"])
    folders = [path for path in tmp_path.iterdir() if path.is_dir() and path.name.startswith("case_")]
    assert len(folders) == 2 and all((path / "train.csv").exists() for path in folders)
