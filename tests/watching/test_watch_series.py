"""Series of recordings: what is alarmed, what not, how fast it grows, and what stays the same after an interruption."""

import json
import os
import shutil
import signal
import threading
import time

import numpy as np
import pyarrow.parquet as pq
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.results import write_watch
from hydrolek_drake.watching.trends import reached
from hydrolek_drake.watching.watch import watch

DAY = 86400.0

pytestmark = [pytest.mark.xdist_group("a watched series"), pytest.mark.thorough]


@pytest.fixture(scope="module")
def leaking(machine_days, references, tmp_path_factory):
    """Watched in one go, and the folder."""
    out = tmp_path_factory.mktemp("whole")
    files = sorted((machine_days / "leaking").glob("*.csv"))
    watched = watch(load_rig("joint_bench"), references, files, folder=out, cores=1)
    write_watch(watched, out)
    return watched, out


def test_a_growing_leakage_is_alarmed_by_name_since_its_first_recordings(leaking):
    watched, _ = leaking
    assert watched.alarm is not None and watched.alarm.effect == "cylinder.cross_port_leakage"
    assert not watched.alarm.as_well and not watched.alarm.unlisted
    assert 2 <= watched.alarm.since <= 3 and watched.alarm.raised <= 4
    assert not any(judgement.beyond for judgement in watched.judgements[:2])


def test_the_growth_is_told_to_a_tenth_and_the_limit_forecast(leaking, growth):
    watched, _ = leaking
    trend = watched.trend("cylinder.cross_port_leakage", "joint")
    assert trend.last is not None and trend.moves
    assert trend.last.slope * DAY == pytest.approx(growth, rel=0.1)
    limit = 12.0 * growth  # of the 14th day, on which no recording was made
    when = reached(trend.last, limit)
    day = (when.likeliest - watched.asked[0].stamp.seconds) / DAY
    assert day == pytest.approx(13.0, abs=1.0) and when.earliest < when.likeliest < when.latest


def test_sizes_lie_in_their_intervals(leaking, planted, growth):
    watched, _ = leaking
    told = [
        next(e for e in answer.effects if e.effect == "cylinder.cross_port_leakage")
        for answer in watched.answers
    ]
    # a planted size may be one interval off in a series of seven
    held = [e.low - 0.01 * p <= p <= e.high + 0.01 * p for e, p in zip(told, planted, strict=True)]
    assert sum(held) >= len(planted) - 1
    assert told[0].low == 0.0 and 0.0 < told[0].high < 0.2 * growth
    # an end that no fit has shown would lie anywhere: of what is surely there both are about as far off
    ends = [(e.size - e.low, e.high - e.size) for e, p in zip(told, planted, strict=True) if p > 0.0]
    assert all(max(each) < 4.0 * min(each) for each in ends)


def test_what_has_grown_large_is_told_to_its_size(machine_days, references):
    """It bends the machine's own numbers, from which a fit with it would end in a local minimum."""
    files = sorted((machine_days / "warm").glob("*.csv"))
    watched = watch(load_rig("joint_bench"), references, files, cores=1)
    for answer in watched.answers:
        first = answer.effects[0]
        assert first.effect == "fluid.warm_up" and first.left < 1.06
        assert first.size == pytest.approx(0.15, rel=0.1)


def test_beside_the_leakage_nothing_else_is_there(leaking):
    watched, _ = leaking
    last = watched.answers[-1]
    assert last.effects[0].effect == "cylinder.cross_port_leakage"
    beside = [e.beside_gain for e in last.effects[1:] if e.beside_gain is not None]
    assert len(beside) > 12 and max(beside) < 0.01 * last.effects[1].gain
    assert watched.answers[0].effects[0].beside_gain is None  # a healthy recording has no first effect


def test_a_healthy_series_gives_no_alarm_and_a_broken_file_is_listed(
    leaking, machine_days, references, tmp_path
):
    folder = tmp_path / "healthy"
    shutil.copytree(machine_days / "healthy", folder)
    (folder / "run_2026-03-09.csv").write_bytes(b"\x00\xffnothing")
    out = tmp_path / "out"
    out.mkdir()
    shutil.copy(leaking[1] / "reference.json", out)  # of the same machine
    arguments = ["watch", "joint_bench", *map(str, references), "--recordings", str(folder)]
    assert run([*arguments, "--workers", "1", "--out", str(out)]) == 0
    table = pq.read_table(out / "watch.parquet").to_pylist()
    broken = [row for row in table if row["problem"]]
    assert len(broken) == 1 and broken[0]["recording"].endswith("run_2026-03-09.csv")
    assert len({row["recording"] for row in table if row["effect"] and not row["reference"]}) == 4
    page = (out / "watch.html").read_text()
    told = [part in page for part in ("no alarm", "run_2026-03-09.csv", "<script src", "<link")]
    assert told == [True, True, False, False]  # it needs no network


def test_an_interrupted_watch_ends_with_the_same_table(leaking, machine_days, references, tmp_path, capsys):
    _, whole = leaking
    out = tmp_path / "resumed"
    shutil.copytree(whole, out)  # as far as an earlier run came: two recordings and a table are missing,
    for path in sorted((out / "seen").iterdir())[:2]:
        path.unlink()
    damaged = sorted((out / "seen").iterdir())[0]
    damaged.write_bytes(damaged.read_bytes()[:100])  # and one is torn, as a disk may leave it
    (out / "watch.parquet").unlink()
    files = str(machine_days / "leaking")
    arguments = ["watch", "joint_bench", *map(str, references), "--recordings", files, "--workers", "1"]
    assert run([*arguments, "--out", str(out)]) == 3  # an alarm
    said = capsys.readouterr()
    assert "Alarm since" in said.out
    assert said.err.count("recording ") == 3
    again, before = (pq.read_table(folder / "watch.parquet").to_pylist() for folder in (out, whole))
    assert _told(again) == _told(before)


def _told(rows):
    return [tuple("nan" if isinstance(v, float) and np.isnan(v) else v for v in row.values()) for row in rows]


def test_another_reference_is_refused(leaking, references):
    _, whole = leaking
    arguments = ["watch", "joint_bench", str(references[0]), "--recordings", str(references[1])]
    assert run([*arguments, "--out", str(whole)]) == 2


def test_kept_recordings_are_whole_json(leaking, planted):
    _, whole = leaking
    kept = [json.loads(path.read_text()) for path in (whole / "seen").iterdir()]
    assert len(kept) == len(planted) and len({each["seen"]["digest"] for each in kept}) == len(planted)


def _kill_once_seen(victim, seen):
    until = time.monotonic() + 120.0
    while not list(seen.glob("*.json")) and time.monotonic() < until:
        time.sleep(0.05)
    os.kill(victim, signal.SIGKILL)


@pytest.mark.long("a cluster's workers load the model: a minute")
def test_over_a_cluster_the_table_is_the_same(machine_days, references, leaking, cluster, tmp_path):
    """Also where a worker dies with the first recording that is kept."""
    _, whole = leaking
    victim = next(iter(cluster.workers.values())).pid
    killed = threading.Thread(target=_kill_once_seen, args=(victim, tmp_path / "seen"))
    killed.start()
    files = [str(machine_days / "leaking")]
    arguments = [*map(str, references), "--recordings", *files, "--out", str(tmp_path)]
    status = run(["watch", "joint_bench", *arguments, "--cluster", cluster.scheduler_address])
    killed.join()
    assert status == 3
    assert next(iter(cluster.workers.values())).pid != victim
    one, other = (pq.read_table(folder / "watch.parquet").to_pylist() for folder in (whole, tmp_path))
    assert len(one) == len(other)
    for row, there in zip(one, other, strict=True):
        assert row.keys() == there.keys()
        for key, value in row.items():
            near = isinstance(value, float)
            assert there[key] == (
                pytest.approx(value, rel=1e-6, abs=1e-30, nan_ok=True) if near else value
            ), key
