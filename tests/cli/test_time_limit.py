"""A diagnosis that ends after a given time tells what is known by then."""

import signal
import time
from pathlib import Path

import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.runs.time_limit import ended_after

PAIR = Path(__file__).parents[1] / "data" / "bench" / "practice_05"


def _busy(seconds: float) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass


def test_a_run_is_interrupted_once_and_the_signal_is_given_back() -> None:
    before = signal.getsignal(signal.SIGALRM)
    with ended_after(0.05) as limit:
        with pytest.raises(KeyboardInterrupt):
            _busy(10.0)
        assert limit.reached
        _busy(0.1)  # what is known by then is told without another one
    assert signal.getsignal(signal.SIGALRM) is before


def test_a_run_that_ends_before_is_left_alone() -> None:
    for seconds in (None, 0.2):
        with ended_after(seconds) as limit:
            _busy(0.01)
        _busy(0.3 if seconds else 0.0)
        assert not limit.reached


@pytest.mark.parametrize(
    ("minutes", "told"), [("1e-4", "ended before anything could be told"), ("0", "must be more than 0")]
)
def test_a_limit_that_tells_nothing_is_refused_in_one_line(minutes, told, capsys) -> None:
    given = ["diagnose", "joint_bench", str(PAIR / "train.csv"), "--at-most", minutes]
    assert run(given) == 2
    assert told in capsys.readouterr().err


def test_a_fit_that_its_limit_ends_gives_the_best_so_far(tmp_path, capsys) -> None:
    given = ["fit", "joint_bench", str(PAIR / "train.csv"), "--at-most", "0.02", "--no-confirm"]
    assert run([*given, "--out", str(tmp_path)]) == 0
    assert "ended after 0.02 min, with the best so far" in capsys.readouterr().out
    assert (tmp_path / "rig_fitted.yaml").exists()


def test_a_fit_of_no_time_is_refused_in_one_line(capsys) -> None:
    assert run(["fit", "joint_bench", str(PAIR / "train.csv"), "--at-most", "0"]) == 2
    assert "must be more than 0" in capsys.readouterr().err
