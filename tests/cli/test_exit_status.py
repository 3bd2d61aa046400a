"""Every bad input is one line on stderr that says what is wrong, and exit status 2."""

import subprocess
import sys
from pathlib import Path

import pytest

from hydrolek_drake.cli.app import COMMANDS, run

ROOT = Path(__file__).parents[2]
TRAIN = str(ROOT / "tests" / "data" / "bench" / "practice_01" / "train.csv")
HEADER = "time_s,joint.command_V,joint.angle_deg\n"


@pytest.fixture
def refused(capsys):
    """Runs a command line and returns the one line with which it was refused."""

    def line(*arguments):
        status = run([str(argument) for argument in arguments])
        said = capsys.readouterr()
        assert status == 2
        assert said.out == ""
        assert said.err.startswith("hydrolek: ")
        assert said.err.count("\n") == 1 and said.err.endswith("\n")
        assert "Traceback" not in said.err
        return said.err

    return line


@pytest.fixture
def rig_file(tmp_path):
    def write(text):
        path = tmp_path / "mine.yaml"
        path.write_text("name: mine\nbased_on: joint_bench\n" + text)
        return path

    return write


@pytest.fixture
def recording_file(tmp_path):
    def write(text, name="mine.csv"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


def test_unknown_key_in_a_rig(refused, rig_file):
    line = refused("replay", rig_file("supply:\n  presure: {value: 1, unit: Pa, source: x}\n"), TRAIN)
    assert "mine.yaml" in line and "supply.presure" in line and "did you mean pressure" in line


def test_wrong_unit_in_a_rig(refused, rig_file):
    line = refused("replay", rig_file("supply:\n  pressure: {value: 16, unit: mm, source: x}\n"), TRAIN)
    assert "supply.pressure" in line and "'mm'" in line and "use Pa" in line


def test_impossible_triangle(refused):
    line = refused("replay", "joint_bench", TRAIN, "--set", "linkage.angle_offset=170 deg")
    assert "impossible triangle" in line and "between 0 and 180" in line


def test_missing_column(refused, recording_file):
    path = recording_file("time_s,joint.angle_deg\n0,25\n0.01,25\n0.02,25.1\n")
    line = refused("replay", "joint_bench", path)
    assert "joint.command" in line and "missing" in line and "mine.csv" in line


def test_nan_in_the_command(refused, recording_file):
    path = recording_file(HEADER + "0,0,25\n0.01,,25\n0.02,1,25.1\n")
    assert "joint.command has no value at 0.01 s" in refused("replay", "joint_bench", path)


def test_time_that_runs_backwards(refused, recording_file):
    path = recording_file(HEADER + "0,0,25\n0.02,0,25\n0.01,1,25.1\n")
    assert "backwards" in refused("replay", "joint_bench", path)


def test_empty_file(refused, recording_file):
    assert "is empty" in refused("replay", "joint_bench", recording_file(""))


def test_unreadable_tdms(refused, recording_file):
    path = recording_file(b"TDSm" + bytes(range(256)), "broken.tdms")
    assert "broken.tdms" in refused("replay", "joint_bench", path)


def test_missing_recording(refused, tmp_path):
    assert "does not exist" in refused("replay", "joint_bench", tmp_path / "none.csv")


def test_unknown_rig_names_near_ones(refused):
    assert "joint_bench" in refused("replay", "jont_bench", TRAIN)


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("supply.pressure", "write path=value"),
        ("supply.pressure=12 m", "unit 'm'"),
        ("suply.pressure=12 MPa", "supply.pressure"),
        ("supply.pressure=much", "not a number"),
        ("valve.discharge=-1e999", "not a finite number"),
    ],
)
def test_wrong_settings(refused, setting, expected):
    assert expected in refused("replay", "joint_bench", TRAIN, "--set", setting)


def test_setting_given_twice(refused):
    twice = ("--set", "supply.pressure=12 MPa", "--set", "supply.pressure=13 MPa")
    assert "given twice" in refused("replay", "joint_bench", TRAIN, *twice)


def test_output_folder_that_cannot_be_made(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert run(["replay", "joint_bench", TRAIN, "--out", str(tmp_path / "file" / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["replai"], "did you mean replay"),
        (["--verbose"], "no option '--verbose'"),
        (["replay"], "RIG"),
        (["replay", "joint_bench"], "RECORDING"),
        (["replay", "joint_bench", TRAIN, "--nothing"], "--nothing"),
        (["replay", "joint_bench", TRAIN, "--between", "1"], "--between"),
        (["replay", "joint_bench", TRAIN, "--between", "3", "1"], "start must lie before the end"),
        (["replay", "joint_bench", TRAIN, "--seed", "x"], "--seed"),
        (["replay", "joint_bench", TRAIN, TRAIN], "given twice"),
        (["effects", "cylinder.coulomb_frition"], "did you mean cylinder.coulomb_friction"),
        (["rigs", "emp"], "did you mean emps"),
    ],
)
def test_wrong_command_lines(refused, arguments, expected):
    assert expected in refused(*arguments)


def test_interrupt_is_one_line_and_130(monkeypatch, capsys):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("hydrolek_drake.recordings.read_recording", interrupted)
    assert run(["replay", "joint_bench", TRAIN]) == 130
    assert capsys.readouterr().err == "hydrolek: interrupted\n"


def test_status_reaches_the_shell():
    program = "from hydrolek_drake.cli.app import main; main()"
    result = subprocess.run(
        [sys.executable, "-c", program, "replay", "joint_bench", "none.csv"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 2
    assert result.stderr == "hydrolek: recording none.csv does not exist\n"


def test_help_loads_no_command():
    program = (
        "import sys; from hydrolek_drake.cli.app import run; status = run(['--help']); "
        "assert not {'pydrake', 'plotly', 'matplotlib', 'typer'} & set(sys.modules); sys.exit(status)"
    )
    result = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, timeout=60, check=False
    )
    assert result.returncode == 0, result.stderr
    assert all(name in result.stdout for name in COMMANDS)


@pytest.mark.parametrize("name", list(COMMANDS))
def test_every_command_has_help(name, capsys):
    assert run([name, "--help"]) == 0
    assert "Usage: hydrolek" in capsys.readouterr().out
