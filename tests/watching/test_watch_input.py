"""What is wrong with a watch's arguments is said in one line, exit status 2."""

import math

import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.watching.limits import limits_of


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (["--recordings", "nowhere"], "nowhere"),
        (["--recordings", ".", "--false-alarms", "1.5"], "probability"),
        (["--recordings", ".", "--drift", "much"], "--drift much"),
        (["--recordings", ".", "--limit", "cylinder.magic=1"], "no effect"),
        (["--recordings", ".", "--limit", "sensor.nonlinearity=1 MPa"], "MPa"),
        (["--recordings", ".", "--limit", "sensor.nonlinearity"], "EFFECT=SIZE"),
        (["--recordings", "."], "absent.csv"),
        ([], "recordings"),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, list) else "",
)
def test_one_line_and_exit_status_2(extra, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert run(["watch", "joint_bench", "absent.csv", *extra]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1 and said in lines[0]


def test_limits_take_units():
    bench = load_rig("joint_bench")
    [one, other] = limits_of(["sensor.nonlinearity=1 deg", "cylinder.cross_port_leakage=2e-12"], bench)
    assert one.size == pytest.approx(0.0174533, rel=1e-5) and other.size == 2e-12
    with pytest.raises(InputError, match="finite"):
        limits_of(["cylinder.coulomb_friction=inf"], bench)


@pytest.mark.parametrize(
    ("rig", "text", "size"),
    [
        ("emps", "linkage.backlash=5 mm", 5e-3),
        ("emps", "load.coulomb_friction=40 N", 40.0),
        ("joint_bench", "linkage.backlash=2 deg", math.radians(2.0)),
        ("joint_bench", "load.coulomb_friction=40 N m", 40.0),
    ],
)
def test_limits_take_the_unit_that_an_effect_has_at_the_rigs_joint(rig, text, size):
    [limit] = limits_of([text], load_rig(rig))
    assert limit.size == pytest.approx(size)


def test_a_unit_that_no_joint_has_is_told_for_the_one_that_it_has():
    with pytest.raises(InputError, match="the size is in m,"):
        limits_of(["linkage.backlash=3 kg"], load_rig("emps"))


@pytest.mark.parametrize(
    ("extra", "said"),
    [
        (["--live", "nowhere.csv"], "nowhere.csv"),
        (["--live", "tcp://127.0.0.1"], "HOST:PORT"),
        (["--live", "run.parquet"], "while they are written"),
        (["--live", "run.csv", "--recordings", "."], "either --recordings or --live"),
        (["--recordings", ".", "--port", "6351"], "--port"),
        (["--recordings", ".", "--foxglove", "8765"], "--foxglove"),
        (["--live", "run.csv", "--idle", "-1"], "--idle"),
        (["--live", "run.csv", "--token", "short"], "--token"),
    ],
    ids=lambda each: " ".join(each) if isinstance(each, list) else "",
)
def test_what_is_wrong_with_live_is_said_in_one_line(extra, said, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "healthy.csv").write_text("time_s,joint.command_V,joint.angle_deg\n0,1,2\n0.01,1,2\n")
    for name in ("run.csv", "run.parquet"):
        (tmp_path / name).write_text("")
    assert run(["watch", "joint_bench", "healthy.csv", *extra]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert said in lines[-1]
