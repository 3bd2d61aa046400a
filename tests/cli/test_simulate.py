"""`hydrolek simulate` and `hydrolek show`: what they write, say and refuse."""

import base64
import json
import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.runs.running import run_scenario
from hydrolek_drake.scenarios.scenario import scenario_files

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    out = tmp_path_factory.mktemp("bench")
    assert run(["simulate", "random_one_joint", "--set", "scenario.duration=1.5", "--out", str(out)]) == 0
    return out


@pytest.fixture(scope="module")
def arms(tmp_path_factory):
    out = tmp_path_factory.mktemp("arms")
    assert run(["simulate", "both_arms", "--set", "scenario.duration=1.5 s", "--out", str(out)]) == 0
    return out


def needs_no_network(page: str) -> bool:
    """No element of the page loads anything from elsewhere."""
    return not re.search(r"<(script|link|img|iframe)[^>]*\s(src|href)\s*=\s*[\"']https?:", page)


def test_folder_is_complete(arms, bench):
    names = {"signals.parquet", "signals.png", "simulate.html", "replay3d.html", "run.json"}
    for folder in (arms, bench):
        assert {path.name for path in folder.iterdir()} == names
        assert (folder / "signals.png").read_bytes().startswith(b"\x89PNG")


def test_signals_have_the_names_of_recordings(arms):
    recording = read_recording(arms / "signals.parquet")
    columns = {"angle", "command", "pressure_a", "pressure_b"}
    for side in ("right", "left"):
        for number in range(1, 8):
            assert {f"{side}_j{number}.{name}" for name in columns} <= set(recording.signals)
    assert recording.signal("supply.pressure")[0] == pytest.approx(16e6)
    assert recording.signal("right_j2.angle")[0] == pytest.approx(np.radians(25.0))
    # 40 % on joint 2 from 1 s: Table 6.3's 1.3 V and 2.49 V, equation (4.2)
    assert recording.signal("right_j2.command")[-1] == pytest.approx(1.3 + 0.4 * (2.49 - 1.3))


def test_page_says_what_was_run(arms):
    page = (arms / "simulate.html").read_text()
    numbers = json.loads((arms / "run.json").read_text())
    assert numbers["scenario"] == "both_arms" and numbers["rig"] == "hydrolek"
    assert "ran for 1.5 s on operator" in page and needs_no_network(page)
    assert len(numbers["joints"]) == 14 and all(joint in page for joint in numbers["joints"])
    assert numbers["joints"]["right_j2"]["highest"] > numbers["joints"]["right_j2"]["start"]


def test_3d_replay_stands_alone_and_moves(arms):
    page = (arms / "replay3d.html").read_text()
    assert needs_no_network(page) and "MeshCat.Viewer" in page
    commands = [base64.b64decode(text) for text in re.findall(r"octet-binary;base64,([^\"]+)", page)]
    animation = next(command for command in commands if b"set_animation" in command[:200])
    for part in (b"right_link2", b"right_j2_rod", b"left_j5_barrel"):
        assert part in animation
    assert len(animation) > 10_000  # poses of 45 frames, not of one


def test_replay_takes_the_signals(bench, capsys):
    assert run(["replay", "joint_bench", str(bench / "signals.parquet"), "--out", str(bench / "again")]) == 0
    numbers = json.loads((bench / "again" / "replay.json").read_text())
    (angle,) = (signal for signal in numbers["signals"] if signal["signal"] == "joint.angle")
    assert np.degrees(angle["largest"]) < 0.02
    for path in (bench / "again").iterdir():
        path.unlink()
    (bench / "again").rmdir()


def test_seed_decides_random_commands(tmp_path):
    def commands(*seed: str) -> np.ndarray:
        arguments = ["simulate", "random_one_joint", "--set", "scenario.duration=1", "--out", str(tmp_path)]
        assert run([*arguments, *seed]) == 0
        return read_recording(tmp_path / "signals.parquet").signal("joint.command")

    first, again, other = commands("--seed", "5"), commands("--seed", "5"), commands("--seed", "6")
    assert np.array_equal(first, again) and not np.array_equal(first, other)


def test_show_draws_a_saved_run_without_a_plant(arms, tmp_path):
    page = tmp_path / "show.html"
    program = (
        "import sys\n"
        "import pydrake.multibody.plant as plant, pydrake.systems.framework as framework\n"
        "def refused(*_, **__): raise AssertionError('built')\n"
        "plant.MultibodyPlant.__init__ = refused\n"
        "framework.DiagramBuilder.__init__ = refused\n"
        "from hydrolek_drake.cli.app import run\n"
        "sys.exit(run(sys.argv[1:]))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program, "show", str(arms), "--out", str(page)],
        cwd=ROOT, capture_output=True, text=True, timeout=60, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    text = page.read_text()
    assert needs_no_network(text) and "set_animation" not in text[:100] and len(text) > 1_000_000


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["simulate"], list(scenario_files())),
        (["simulate", "both_arm"], ["did you mean both_arms", *scenario_files()]),
        (["simulate", "both_arms", "--set", "scenario.duraton=5"], ["scenario.duraton", "duration"]),
        (["simulate", "both_arms", "--set", "supply.presure=5"], ["supply.pressure"]),
        (["simulate", "both_arms", "--seed", "-1"], ["--seed"]),
        (["simulate", "random_one_joint", "--set", "scenario.command.operator=true"], ["percent"]),
        (["show"], ["DIR"]),
        (["show", "none.parquet"], ["none.parquet", "does not exist"]),
        (["show", str(ROOT / "tests/data/bench/practice_01/train.csv")], ["no angle of a joint of the arms"]),
    ],
)
def test_bad_input_is_one_line(arguments, expected, capsys):
    assert run(arguments) == 2
    said = capsys.readouterr().err
    assert said.startswith("hydrolek: ") and said.count("\n") == 1
    assert all(part in said for part in expected), said


def test_folder_that_cannot_be_made_is_refused_before_the_run(tmp_path, capsys):
    (tmp_path / "file").write_text("")
    assert run(["simulate", "both_arms", "--out", str(tmp_path / "file" / "out")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.fixture
def interruptible():
    """Ctrl-C interrupts, also where the tests were started in the background, which ignores it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.usefixtures("interruptible")
def test_interrupt_keeps_what_is_done(tmp_path, capsys, monkeypatch):
    def interrupting(*arguments, on_progress, **options):
        def progress(now: float) -> None:
            on_progress(now)
            if now >= 1.0:
                os.kill(os.getpid(), signal.SIGINT)  # as Ctrl-C does

        return run_scenario(*arguments, on_progress=progress, **options)

    monkeypatch.setattr("hydrolek_drake.runs.running.run_scenario", interrupting)
    arguments = ["simulate", "random_one_joint", "--set", "scenario.duration=200", "--out", str(tmp_path)]
    assert run(arguments) == 130
    assert capsys.readouterr().err.endswith("hydrolek: interrupted\n")
    recording = read_recording(tmp_path / "signals.parquet")
    assert 1.0 <= recording.time[-1] < 3.0
    assert json.loads((tmp_path / "run.json").read_text())["interrupted"] is True
    assert "was interrupted" in (tmp_path / "simulate.html").read_text()
