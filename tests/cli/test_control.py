"""`hydrolek control`: what it prints and writes, and what it refuses."""

import json

import pytest
import yaml

from hydrolek_drake.cli.app import run


def test_bench_prints_the_ranking_and_writes_the_report(printed, tmp_path):
    text = printed(
        "control", "bench", "--controller", "pip_idz_c", "--controller", "feedforward", "--sequence", "step",
        "--out", tmp_path / "out",
    )  # fmt: skip
    numbers = json.loads((tmp_path / "out" / "bench.json").read_text())
    assert numbers["sentence"] in text
    assert "worst rise [s]" in text and "PIP IDZ c" in text
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written == {"bench.html", "bench.json", "step.png", "step_path.png"}


def test_design_from_the_thesis_gives_table_6_6(printed, tmp_path):
    text = printed("control", "design", "thesis", "j2", "--weights", 2, 1000, 1, "--out", tmp_path / "c.yaml")
    tree = yaml.safe_load((tmp_path / "c.yaml").read_text())
    assert yaml.safe_load(text) == tree
    assert tree["gains"]["f"] == pytest.approx([0.3371], abs=5e-5)
    assert tree["gains"]["k_i"] == pytest.approx(0.0385, abs=5e-5)


def test_design_from_a_rig_and_again_from_its_own_file(printed, tmp_path):
    first = yaml.safe_load(printed("control", "design", "hydrolek_left_j5", "--out", tmp_path / "j5.yaml"))
    assert first["delay_control_samples"] == 3
    again = yaml.safe_load(
        printed("control", "design", tmp_path / "j5.yaml", "--pole", "0.7+0.05j", "--pole", "0.7-0.05j")
    )
    assert again["model"] == first["model"]
    assert again["gains"]["g"][0] == pytest.approx(0.6)  # Table 6.6, joint 2a


def test_judge_tells_how_many_cases_meet_the_aim(printed, tmp_path):
    text = printed(
        "control", "judge", "--controller", "feedforward", "--joint", "right_j3", "--machines", 0,
        "--out", tmp_path / "judge.json",
    )  # fmt: skip
    assert "objectives met" in text and "feedforward, learning" in text
    cases = json.loads((tmp_path / "judge.json").read_text())["cases"]
    assert len(cases) == 28
    assert all(case["meets_objectives"] for case in cases)


def test_tune_keeps_or_improves_the_tuning(printed, tmp_path):
    printed(
        "control", "tune", "--joint", "right_j3", "--machines", 0, "--trials", 2, "--out", tmp_path / "t.json"
    )
    assert json.loads((tmp_path / "t.json").read_text())["gain"] > 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("bench", "--controller", "magic"), "no controller 'magic'; choose pi"),
        (("bench", "--sequence", "dance"), "choose step, sine, grasp"),
        (("bench", "--set", "supply.pressure=12 MPa"), "belong to --plant full"),
        (("design", "thesis", "j9"), "no SDP model 'j9'"),
        (("design", "hydrolek"), "has several joints"),
        (("design", "thesis", "j2", "--pole", "fast"), "write a number such as"),
        (("design", "thesis", "j2", "--pole", "1.5"), "inside the unit circle"),
        (("design", "thesis", "j2", "--pole", "0.5", "--weights", "1", "1", "1"), "not both"),
        (("judge", "--joint", "right_j9"), "choose right_j1"),
        (("design", "emps"), "no turning joint"),
    ],
)
def test_bad_input_is_one_line(capsys, arguments, message):
    assert run(["control", *arguments]) == 2
    said = capsys.readouterr().err
    assert message in said and said.count("\n") == 1


def test_a_model_file_with_a_wrong_number_of_coefficients_is_refused(capsys, tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text("alpha: [1, 2, 3]\ndelay_samples: 15\nrange_deg: [-10, 10]\n")
    assert run(["control", "design", str(path)]) == 2
    assert "alpha has 3 and beta 0 numbers" in capsys.readouterr().err
