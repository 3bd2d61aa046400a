"""An interrupt after the judgement costs the visible sizes and not the verdict."""

import json
from pathlib import Path

from hydrolek_drake.cli.app import run
from hydrolek_drake.diagnosis import diagnosis

PAIR = Path(__file__).parents[1] / "data" / "bench" / "practice_01"


def test_what_was_judged_is_kept_and_written(tmp_path, monkeypatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(diagnosis, "visible_sizes", interrupted)
    recordings = [str(PAIR / "train.csv"), "--holdout", str(PAIR / "holdout.csv")]
    status = run(["diagnose", "joint_bench", *recordings, "--out", str(tmp_path)])
    report = json.loads((tmp_path / "report.json").read_text())
    assert status == 130
    assert report["verdict"] == "none"
    assert report["fit"]["with_effects"]["holdout_over_noise"] < 1.1
    assert report["detectable_from"] == {}
