"""FMUs as concealed machines of a challenge: what the list says, what is recorded, and what is refused."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.challenge.plants import read_plants, record_plant
from hydrolek_drake.cli.app import run
from hydrolek_drake.recordings import Recording, read_recording
from hydrolek_drake.recordings.writing import write_recording

pytest.importorskip("fmpy", reason="needs the extra fmu")

pytestmark = pytest.mark.long("two minutes: each unit is a process that loads all anew")

NAMES = "map: {voltage: joint.command_V, stroke_mm: joint.angle_mrad, bar: joint.pressure_a_bar}"


@pytest.fixture
def listed(stranger: Callable[..., Path], tmp_path: Path) -> Callable[[str], Path]:
    """Further lines of a case -> a list with one case, of a unit that stands beside it."""

    def write(more: str) -> Path:
        (tmp_path / "plain.fmu").write_bytes(stranger("Foreign").read_bytes())
        times = 0.01 * np.arange(100)
        for side, volts in (("train", 2.0), ("holdout", -1.0)):
            command = {"joint.command": np.where(times < 0.5, 0.0, volts)}
            write_recording(Recording(side, times, command, Path(side)), tmp_path / f"{side}.csv")
        path = tmp_path / "plants.yaml"
        files = "fmu: plain.fmu\n    rig: joint_bench\n    train: train.csv\n    holdout: holdout.csv"
        path.write_text(f"cases:\n  one:\n    {files}\n    {NAMES}\n    {more}\n")
        return path

    return write


def test_a_plant_is_recorded_with_its_sensors_and_its_label_says_what_it_conceals(
    listed: Callable[[str], Path], tmp_path: Path
) -> None:
    path = listed(
        "conceals: {fluid.entrained_air: {}, supply_ripple: {}}\n    stage: supply\n    set: {gain: 40}"
    )
    plant = read_plants(path)["one"]
    assert (plant.label["kind"], plant.label["stages"]) == ("unlisted", ["supply", "fluid"])
    assert plant.label["pressures"]
    record_plant(plant, tmp_path / "made")
    recording = read_recording(tmp_path / "made" / "train.csv")
    noise = plant.sensors.noise["joint.angle"]
    ideal = 0.1 + 40e-3 * 0.01 * np.concatenate([[0.0], np.cumsum(recording.signals["joint.command"])[:-1]])
    left = recording.signals["joint.angle"] - ideal
    assert left.std() == pytest.approx(noise, rel=3.0 / np.sqrt(2 * left.size))


@pytest.mark.parametrize(
    ("more", "said"),
    [
        ("conceals: {supply_ripple: {}}", "'stage' must say where it acts"),
        ("conceals: {fluid.entrained_air: {share: 1}}", "no parameter 'share'"),
        ("size: huge", "choose barely, middle, large"),
        ("noise: {joint.angle: 1}", "has no unit"),
        ("set: {gain: much}", "'much' is no number"),
        ("gain: 3", "'gain' is not known"),
        ("seed: [1]", "is no int"),
    ],
)
def test_a_wrong_list_is_refused_in_one_line(
    more: str, said: str, listed: Callable[[str], Path], tmp_path: Path, capsys: pytest.CaptureFixture
) -> None:
    arguments = ["challenge", "--plants", str(listed(more)), "--out", str(tmp_path / "out")]
    assert run(arguments) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1
    assert not (tmp_path / "out").exists()
