"""Scenarios that name a controller and its set points: steps in the file, or a recording."""

import json

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.controlled_station import run_controlled
from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, read_recording, write_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.runs.running import run_scenario
from hydrolek_drake.runs.signals import named_signals
from hydrolek_drake.scenarios.scenario import load_scenario

ARM = """schema: 1
rig: hydrolek_right_j2
duration: 4 s
forces: moments
command: {kind: controlled, controller: feedforward, joints: {right_j2: [[0 s, 25 deg], [1 s, 40 deg]]}}
"""


def test_a_joint_goes_where_the_steps_of_the_file_say(scenario_file):
    done = run_scenario(load_scenario(scenario_file(ARM)))
    signals, units = named_signals(done)
    assert units["right_j2.reference"] == "deg"
    wanted, angle = signals["right_j2.reference"], signals["right_j2.angle"]
    assert set(wanted[done.run.time < 0.999].round(9)) == {25.0} and wanted[-1] == pytest.approx(40.0)
    assert np.abs(angle[done.run.time < 1.0] - 25.0).max() < 0.1  # nothing moves before the step
    assert angle[-1] == pytest.approx(40.0, abs=0.1)
    volts = signals["right_j2.command"]
    assert (
        np.unique(volts[done.run.time < 0.999]).tolist() == [0.0] and volts.max() > 1.3
    )  # beyond the dead-zone


def test_it_is_the_loop_of_the_controllers_bench(scenario_file):
    """The same rig, law and set points give the same angles to the last digit, at the same steps."""
    scenario = load_scenario(scenario_file(ARM.replace("4 s", "2 s")))
    done = run_scenario(scenario)
    rig = load_rig("hydrolek_right_j2")
    law = build_law("feedforward", rig_setting(rig, "right_j2"), noisy=False)
    wanted = np.where(np.arange(40) < 20, 25.0, 40.0)[:, None]
    other = run_controlled(rig, {"right_j2": law}, wanted, 0.05, sizes=scenario.sizes)
    rows = np.searchsorted(done.run.time, other.time_s - 1e-9)
    np.testing.assert_allclose(
        np.degrees(done.run.signals["reading"][rows, 0]), other.angle_deg[:, 0], atol=1e-9
    )


@pytest.mark.parametrize("suffix", ("csv", "parquet"))
@pytest.mark.parametrize("quantity", ("angle", "reference"))
def test_set_points_are_read_from_a_file(scenario_file, tmp_path, suffix, quantity):
    """Measured angles are joined by lines, references are held; a path begins beside the scenario."""
    time = 7.0 + np.array([0.0, 1.0, 2.0])  # need not begin at zero
    values = np.radians([25.0, 35.0, 30.0])
    signals = {f"right_j2.{quantity}": values}
    write_recording(Recording("r", time, signals, tmp_path), tmp_path / f"wanted.{suffix}")
    text = ARM.replace("[[0 s, 25 deg], [1 s, 40 deg]]", f"{{recording: wanted.{suffix}}}")
    table = load_scenario(scenario_file(text)).controlled.table_deg(4.0, 0.5)[:, 0]
    between = [30.0, 32.5] if quantity == "angle" else [25.0, 35.0]
    expected = [25.0, between[0], 35.0, between[1], 30.0, 30.0, 30.0, 30.0]  # the last one holds on
    assert table == pytest.approx(expected)


def test_a_run_is_a_file_of_set_points(scenario_file, tmp_path):
    """What one run's joint did is what the next is to do, or what the first was told."""
    first = scenario_file(ARM.replace("4 s", "1.5 s"))
    assert run(["simulate", str(first), "--out", str(tmp_path / "one")]) == 0
    saved = read_recording(tmp_path / "one" / "signals.parquet")
    assert {"right_j2.reference", "right_j2.angle"} <= set(saved.signals)
    source = "{recording: one/signals.parquet, signal: right_j2.%s}"
    for quantity in ("angle", "reference"):
        text = ARM.replace("[[0 s, 25 deg], [1 s, 40 deg]]", source % quantity)
        table = load_scenario(scenario_file(text)).controlled.table_deg(1.5, 0.05)[:, 0]
        wanted = np.degrees(saved.signal(f"right_j2.{quantity}"))[:-1:5]
        assert table == pytest.approx(wanted, abs=1e-6)
    numbers = json.loads((tmp_path / "one" / "run.json").read_text())
    assert "under feedforward" in numbers["sentence"] and "off their set points" in numbers["sentence"]


def test_withdrawn_set_points_close_the_valves(scenario_file):
    path = scenario_file(ARM.replace("4 s", "2 s") + "events: {commands_zero_at: 1.4 s}\n")
    done = run_scenario(load_scenario(path))
    signals, _ = named_signals(done)
    late = done.run.time >= 1.4 - 1e-9
    assert np.abs(signals["right_j2.command"][~late]).max() > 1.3
    assert (signals["right_j2.command"][late] == 0.0).all() and np.isnan(
        signals["right_j2.reference"][late]
    ).all()


def test_a_valve_with_a_neutral_voltage_is_driven_about_it(scenario_file):
    text = (
        ARM.replace("hydrolek_right_j2", "joint_bench").replace("right_j2", "joint").replace("4 s", "2.5 s")
    )
    text = text.replace("25 deg", "0 deg").replace("40 deg", "15 deg").replace("feedforward", "pi")
    done = run_scenario(
        load_scenario(
            scenario_file(text + "settings: {command.neutral: 5 V}\ninitial_position: {joint: 0 deg}\n")
        )
    )
    signals, _ = named_signals(done)
    before = (done.run.time > 0.1) & (done.run.time < 0.999)
    assert set(signals["joint.command"][before]) == {5.0}
    assert signals["joint.command"].max() > 5.5 and signals["joint.angle"][-1] > 7.5


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("controller: feedforward", "controller: feedforwad", ["'feedforwad'", "pip_idz_c"]),
        ("controller: feedforward", "controller: {right_j2: 3}", ["controller.right_j2", "'3'"]),
        ("controller: feedforward", "controller: {right_j3: pi}", ["controller.right_j3", "no set points"]),
        ("controller: feedforward,", "", ["controller is missing"]),
        ("{right_j2: [[0 s, 25 deg], [1 s, 40 deg]]}", "{}", ["joints", "right_j2"]),
        ("right_j2: [[0 s, 25 deg]", "right_j3: [[0 s, 25 deg]", ["joints.right_j3", "choose right_j2"]),
        ("25 deg", "25 V", ["right_j2[0]", "'V'"]),
        ("[1 s, 40 deg]", "[0 s, 40 deg]", ["right_j2[1]", "does not come after"]),
        ("[[0 s, 25 deg], [1 s, 40 deg]]", "{recording: none.csv}", ["right_j2.recording", "does not exist"]),
        ("[[0 s, 25 deg], [1 s, 40 deg]]", "{recording: a.csv, column: 3}", ["right_j2.column", "signal"]),
        (
            "[[0 s, 25 deg], [1 s, 40 deg]]",
            "{recording: here.csv}",
            ["right_j2.reference is missing", "here.csv"],
        ),
        (
            "[[0 s, 25 deg], [1 s, 40 deg]]",
            "{recording: here.csv, signal: right_j3.force}",
            ["right_j3.force is in N", "rad is needed"],
        ),
        ("kind: controlled,", "kind: controlled, operator: true,", ["operator", "controller"]),
    ],
)
def test_wrong_files_are_refused_in_one_line(scenario_file, tmp_path, old, new, expected):
    (tmp_path / "here.csv").write_text("time_s,right_j3.angle_deg,right_j3.force_N\n0,1,2\n1,2,3\n2,3,3\n")
    text = ARM.replace(old, new)
    assert text != ARM
    with pytest.raises(InputError) as refusal:
        load_scenario(scenario_file(text))
    message = str(refusal.value)
    assert "\n" not in message and all(part in message for part in expected), message


def test_a_joint_without_stops_is_refused_in_one_line(scenario_file):
    text = ARM.replace("hydrolek_right_j2", "emps").replace("right_j2", load_rig("emps").joints[0])
    with pytest.raises(InputError, match="turning joint"):
        load_scenario(scenario_file(text))
