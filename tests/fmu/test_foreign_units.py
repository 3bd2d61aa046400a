"""Units of other programs take a machine's place; those that cannot are refused in one line, and nothing is left."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.recordings.writing import write_recording
from hydrolek_drake.replay import compare, replay
from hydrolek_drake.rigs import Rig

pytest.importorskip("fmpy", reason="needs the extra fmu")

pytestmark = pytest.mark.long("two minutes: each unit is a process that loads all anew")

MAPPED = ("--map", "voltage=slide.command_V", "--map", "stroke_mm=slide.position_mm")


@pytest.fixture
def command(tmp_path: Path, volts: np.ndarray) -> Callable[[str], Path]:
    """Joint -> a recording of its command alone."""

    def write(joint: str) -> Path:
        times = 5.0 + 0.01 * np.arange(volts.size)
        recording = Recording("c", times, {f"{joint}.command": volts}, Path("c"))
        return write_recording(recording, tmp_path / "command.csv")

    return write


def test_a_recording_of_the_exported_model_agrees_with_its_rig_to_the_noise(
    exported: Callable[[int], Path], enlarged: Rig, command: Callable[[str], Path], tmp_path: Path
) -> None:
    made = tmp_path / "made.csv"
    noise = ("--noise", "joint.angle_deg=0.05", "--noise", "joint.pressure_a_MPa=0.02", "--seed", "4")
    unit = exported(3)
    assert run(["fmu", "record", str(unit), "--command", str(command("joint")), "-o", str(made), *noise]) == 0
    recording = read_recording(made)
    assert recording.time[0] == 5.0
    angle, pressure = (
        next(each for each in compare(replay(enlarged, recording)) if each.key == key)
        for key in ("joint.angle", "joint.pressure_a")
    )
    few = 3.0 / np.sqrt(2 * recording.time.size)  # three standard errors of a standard deviation
    assert angle.rms == pytest.approx(np.radians(0.05), rel=few)
    assert pressure.rms == pytest.approx(2e4, rel=few)


def test_a_strangers_names_and_units_are_mapped(
    stranger: Callable[..., Path], command: Callable[[str], Path], tmp_path: Path, volts: np.ndarray
) -> None:
    made = tmp_path / "made.parquet"
    arguments = [str(stranger("Slide")), "--command", str(command("slide")), "-o", str(made), *MAPPED]
    arguments += ["--map", "bar=slide.pressure_a_bar", "--set", "gain=30", "--sample-time", "0.02"]
    arguments += ["--resolution", "slide.position_mm=0.5"]
    assert run(["fmu", "record", *arguments]) == 0
    recording = read_recording(made)
    assert recording.time.size == volts.size // 2
    held = volts[::2]
    stroke = 0.1 + 0.03 * 0.02 * np.concatenate([[0.0], np.cumsum(held)[:-1]])
    np.testing.assert_array_equal(recording.signals["slide.command"], held)
    np.testing.assert_allclose(recording.signals["slide.position"], stroke, atol=0.25e-3 + 1e-12)
    np.testing.assert_allclose(recording.signals["slide.position"] % 0.5e-3 % 0.5e-3, 0.0, atol=5e-4)
    np.testing.assert_allclose(recording.signals["slide.pressure_a"], 5e6)


@pytest.mark.parametrize(
    ("does", "seconds", "said"),
    [
        ("os.abort()", "60", "it crashed (SIGABRT)"),
        ("time.sleep(1e4)", "1.5", "it did not end within 1.5 s and was ended; --at-most gives it longer"),
        ("raise ValueError('spool jammed')", "60", "it failed: ValueError("),
        ("self.stroke_mm = math.nan", "60", "its output 'stroke_mm' is not finite at 0.07 s"),
    ],
    ids=["crashes", "hangs", "fails", "not finite"],
)
def test_a_unit_that_does_not_work_is_refused_in_one_line(
    does: str,
    seconds: str,
    said: str,
    stranger: Callable[..., Path],
    command: Callable[[str], Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture,
) -> None:
    unit = stranger("Broken", does)
    made = tmp_path / "made.csv"
    arguments = [
        str(unit),
        "--command",
        str(command("slide")),
        "-o",
        str(made),
        "--at-most",
        seconds,
        *MAPPED,
    ]
    assert run(["fmu", "record", *arguments]) == 2
    told = capsys.readouterr().err
    assert told.startswith(f"hydrolek: {unit}: {said}")
    assert told.count("\n") == 1
    assert not made.exists()


def _changed(unit: Path, out: Path, old: str, new: str, *, names: bool = False) -> Path:
    """The unit with text replaced in its description, or in the names of its files."""
    with zipfile.ZipFile(unit) as source, zipfile.ZipFile(out, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if names:
                name = name.replace(old, new)
            elif name == "modelDescription.xml":
                assert old.encode() in content
                content = content.replace(old.encode(), new.encode())
            target.writestr(name, content)
    return out


def test_what_cannot_take_a_machines_place_is_refused_in_one_line(
    stranger: Callable[..., Path],
    command: Callable[[str], Path],
    tmp_path: Path,
    capsys: pytest.CaptureFixture,
) -> None:
    unit, made = stranger("Plain"), tmp_path / "made.csv"
    driving = ("--command", str(command("slide")), "-o", str(made))
    garbage = tmp_path / "garbage.fmu"
    garbage.write_bytes(b"PK\x03\x04 and nothing that follows")
    elsewhere = _changed(unit, tmp_path / "elsewhere.fmu", "linux64", "sun64", names=True)
    with zipfile.ZipFile(elsewhere) as archive:
        assert "binaries/win64/Plain.dll" in archive.namelist()
    exchange = _changed(unit, tmp_path / "exchange.fmu", "CoSimulation", "ModelExchange")
    old = _changed(unit, tmp_path / "old.fmu", 'fmiVersion="2.0"', 'fmiVersion="1.0"')
    for arguments, said in (
        ((tmp_path / "none.fmu", *MAPPED), "does not exist"),
        ((garbage, *MAPPED), "it is no FMU"),
        ((exchange, *MAPPED), "for model exchange only"),
        ((old, *MAPPED), "FMI 1.0"),
        ((unit,), "no input is a signal of"),
        ((unit, *MAPPED[:2]), "no output is known as a signal"),
        ((unit, *MAPPED, "--map", "strok=slide.position_mm"), "nearest: stroke_mm"),
        ((unit, *MAPPED, "--map", "bar=slide.position_bar"), "does not measure position"),
        ((unit, *MAPPED, "--map", "bar=slide.position_m"), "would both be slide.position"),
        ((unit, *MAPPED, "--set", "volume=1"), "no variable 'volume'"),
        ((unit, *MAPPED, "--sample-time", "-1"), "seconds above 0"),
        ((unit, *MAPPED, "--noise", "slide.angle=1"), "has no unit"),
        ((elsewhere, *MAPPED), "this machine is "),
    ):
        assert run(["fmu", "record", *map(str, arguments), *driving]) == 2, said
        told = capsys.readouterr().err
        assert said in told
        assert told.count("\n") == 1
        assert not made.exists()


def test_show_lists_what_can_be_mapped(stranger: Callable[..., Path], capsys: pytest.CaptureFixture) -> None:
    assert run(["fmu", "show", str(stranger("Shown"))]) == 0
    told = capsys.readouterr().out
    assert "FMI 2.0" in told
    for name in ("voltage", "stroke_mm", "bar", "gain"):
        assert name in told
