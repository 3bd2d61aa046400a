"""Timed trials and ratings: what is written, and what is refused."""

import csv
import threading

import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.trial import COLUMNS, SCALES, TrialLog

GOOD = {"operator": 'A, "B"\nC', "control": "joystick", "note": "", **dict.fromkeys(SCALES, 50)}


def _rows(folder):
    with open(folder / "trials.csv", newline="") as file:
        return list(csv.DictReader(file))


def _timed(log):
    log.timer("start")
    log.timer("stop")


def test_a_trial_is_one_line_with_the_mean_of_its_ratings(tmp_path):
    log = TrialLog(tmp_path / "new")
    _timed(log)
    log.save(GOOD | {"mental": 80, "effort": 20.5})
    assert (tmp_path / "new" / "trials.csv").read_text().count("\n") == 2
    (row,) = _rows(tmp_path / "new")
    assert tuple(row) == COLUMNS and row["operator"] == 'A, "B" C' and row["control"] == "joystick"
    assert float(row["raw_tlx"]) == pytest.approx((80 + 20.5 + 4 * 50) / 6, abs=0.005)
    assert float(row["task_s"]) >= 0.0 and log.state()["seconds"] is None
    with pytest.raises(InputError, match="no time to save"):
        log.save(GOOD)


def test_trials_are_added_to_those_of_before_even_after_an_open_last_line(tmp_path):
    for count in (1, 2, 3):
        log = TrialLog(tmp_path)
        assert log.state()["saved"] == count - 1
        _timed(log)
        log.save(GOOD)
        path = tmp_path / "trials.csv"
        path.write_text(path.read_text().rstrip("\n"))
    assert len(_rows(tmp_path)) == 3


def test_consoles_that_write_at_once_do_not_break_each_other_s_lines(tmp_path):
    logs = [TrialLog(tmp_path) for _ in range(2)]
    _timed(logs[0])
    logs[0].save(GOOD)

    def work(log):
        for _ in range(40):
            _timed(log)
            log.save(GOOD | {"note": "x" * 150})

    threads = [threading.Thread(target=work, args=(log,)) for log in logs]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    rows = _rows(tmp_path)
    assert len(rows) == 81 and all(None not in row and row["raw_tlx"] == "50.00" for row in rows)


def test_the_timer(monkeypatch):
    log, now = TrialLog(None), [100.0]
    monkeypatch.setattr("hydrolek_drake.teleop.trial.time.monotonic", lambda: now[0])
    log.timer("stop")
    assert log.state()["seconds"] is None
    log.timer("start")
    now[0] = 112.34
    assert log.state()["running"] and log.state()["seconds"] == 12.3
    log.timer("stop")
    now[0] = 150.0
    assert log.state()["seconds"] == 12.3
    log.timer("reset")
    assert log.state()["seconds"] is None
    with pytest.raises(InputError, match="choose start, stop, reset"):
        log.timer("explode")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"operator": " "}, "who was the operator"),
        ({"operator": 5}, "must be text"),
        ({"note": "x" * 201}, "at most 200"),
        ({"control": "mind"}, "one of assisted, joystick, sliders"),
        ({"mental": 101}, "mental must be a number from 0 to 100"),
        ({"mental": True}, "mental must be"),
        ({"mental": float("nan")}, "mental must be"),
        ({"happiness": 3}, "'happiness' is unknown"),
    ],
)
def test_ratings_that_are_wrong_write_nothing(tmp_path, change, message):
    log = TrialLog(tmp_path)
    _timed(log)
    with pytest.raises(InputError, match=message):
        log.save(GOOD | change)
    assert not (tmp_path / "trials.csv").exists()


def test_a_running_timer_no_folder_and_another_table_are_told(tmp_path):
    log = TrialLog(tmp_path)
    log.timer("start")
    with pytest.raises(InputError, match="stop it before you save"):
        log.save(GOOD)
    with pytest.raises(InputError, match="start with --out FOLDER"):
        TrialLog(None).save(GOOD)
    (tmp_path / "trials.csv").write_text("a,b\n1,2\n")
    with pytest.raises(InputError, match="its first line is not finished,operator"):
        TrialLog(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another folder"):
        TrialLog(tmp_path / "file")
