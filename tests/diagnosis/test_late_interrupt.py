"""An interrupt of the judgement, or after it, costs what comes then and not what is known."""

import json
from pathlib import Path

import jsonschema
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.diagnosis import diagnosis, inquiry
from hydrolek_drake.diagnosis.report.schema import report_schema

PAIR = Path(__file__).parents[1] / "data" / "bench" / "practice_02"


@pytest.mark.parametrize(
    ("where", "what", "lost", "verdict"),
    [
        pytest.param(
            diagnosis,
            "visible_sizes",
            ("detectable_from",),
            "none",
            marks=pytest.mark.long("takes a third of a minute more"),
        ),
        pytest.param(
            diagnosis,
            "locate",
            ("detectable_from", "locations"),
            "none",
            marks=pytest.mark.long("takes a third of a minute more"),
        ),
        (inquiry, "judge_structures", (), "interrupted"),
    ],
)
@pytest.mark.thorough
def test_what_is_known_is_kept_and_written(tmp_path, monkeypatch, where, what, lost, verdict) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(where, what, interrupted)
    recordings = [str(PAIR / "train.csv"), "--holdout", str(PAIR / "holdout.csv")]
    status = run(["diagnose", "joint_bench", *recordings, "--out", str(tmp_path)])
    report = json.loads((tmp_path / "report.json").read_text())
    jsonschema.Draft202012Validator(report_schema()).validate(report)
    assert status == 130
    assert report["verdict"] == verdict
    assert report["fit"]["with_effects"]["holdout_over_noise"] < 1.1
    assert all(not report[part] for part in lost)
    assert "interrupted" in (tmp_path / "report.html").read_text()
