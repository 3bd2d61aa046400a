"""Two-step identification: Table 4.1's map, the gain model's equation, and the whole course on a simulated joint."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.two_step.gain_rig import gain_path, gain_rig
from hydrolek_drake.identification.two_step.machine import other_machine, set_points_deg
from hydrolek_drake.identification.two_step.settings import (
    hydraulic_ranges,
    mechanical_ranges,
    only_joint,
    two_step_data,
    with_ranges,
)
from hydrolek_drake.physics.solenoid import solenoid_force
from hydrolek_drake.recordings import read_recording
from hydrolek_drake.recordings.writing import write_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.rest import rest_state


def test_sixteen_parameters_of_table_4_1_are_nine_of_every_arm_s_rig():
    table = two_step_data()["table_4_1"]
    assert len(table) == 16
    assert table["Piston area A"]["printed"] == [500, 3500] and table["Solenoid B damping"]["printed"] == [
        0,
        15,
    ]
    for number in range(1, 6):
        joint = f"right_j{number}"
        rig = load_rig(f"hydrolek_{joint}")
        ranges = hydraulic_ranges(rig, joint)
        assert len(ranges) == 9
        for path, (low, high, _) in ranges.items():
            assert low < rig.value(path) < high


def test_two_points_of_a_force_stroke_curve_are_the_two_constants_of_4_5():
    constant, gap = 30.0, 120.0
    strokes = (1e-3, 4e-3)
    first, second = (solenoid_force(1.0, x, constant, gap) for x in strokes)
    ratio = np.sqrt(first / second)
    found = (ratio - 1.0) / (strokes[1] - ratio * strokes[0])
    assert found == pytest.approx(gap)
    assert first * (1.0 + found * strokes[0]) ** 2 == pytest.approx(constant)


def test_gain_model_is_4_1_of_one_joint():
    rig = load_rig("hydrolek_right_j2")
    gain = gain_rig(rig, "right_j2").with_values({gain_path("right_j2"): 200.0, "load.damping": 150.0})
    time = np.arange(0.0, 3.0, 0.01)
    command = np.full(time.size, 2.0)
    start = 0.4
    record = gain.records()
    signals = roll_out(
        record, time, command, time, state=rest_state(record, start), longest_step=1e-4
    ).signals
    q = signals.reading
    inside = (q > np.radians(-9.0)) & (q < np.radians(64.0)) & (time > gain.value("command.delay") + 0.05)
    v = np.gradient(q, time)
    a = np.gradient(v, time)
    left = gain.value("load.inertia") * a + 150.0 * v
    gravity = gain.value("load.gravity_cos") * np.cos(q) + gain.value("load.gravity_sin") * np.sin(q)
    assert inside.sum() > 50
    np.testing.assert_allclose((left + gravity)[inside], 400.0, rtol=0.02)


def test_masses_stay_near_the_cad_model_and_gravity_that_is_none_is_not_searched():
    vertical = mechanical_ranges(load_rig("hydrolek_right_j1"), "right_j1")
    assert {path.rpartition(".")[2] for path in vertical} == {"inertia", "damping"}
    rig = load_rig("hydrolek_right_j5")
    ranges = mechanical_ranges(rig, "right_j5")
    low, high, scale = ranges["joints.right_j5.load.gravity_sin"]  # below zero
    assert low < rig.value("load.gravity_sin") < high < 0.0 and scale == "linear"


def test_a_parameter_that_followed_another_gets_a_range_of_its_own():
    rig = load_rig("hydrolek_right_j4")
    ranges = hydraulic_ranges(rig, "right_j4")
    free = with_ranges(rig, ranges).free_parameters()
    assert set(ranges) <= set(free)
    assert rig.entries["joints.right_j4.cylinder.area_b"].same_as == "area_a"


def test_sequences_cover_the_range_in_both_directions_with_steps_of_many_sizes():
    rig = load_rig("hydrolek_right_j3")
    low, high = np.degrees([rig.value("load.lower_stop"), rig.value("load.upper_stop")])
    for part in ("estimation", "validation"):
        wanted = set_points_deg(rig, part)
        assert np.ptp(wanted) >= 0.9 * (high - low)
        steps = np.diff(wanted)
        steps = steps[steps != 0.0]
        assert (steps > 0).sum() >= 5 and (steps < 0).sum() >= 5
        assert len(set(np.round(np.abs(steps), 6))) >= 5


def test_the_machine_differs_in_every_parameter_that_is_searched_and_by_no_more_than_said():
    rig = load_rig("hydrolek_right_j2")
    machine = other_machine(rig, np.random.default_rng(3))
    for path in [
        *rig.free_parameters(),
        *hydraulic_ranges(rig, "right_j2"),
        *mechanical_ranges(rig, "right_j2"),
    ]:
        ratio = machine.value(path) / rig.value(path)
        most = 1.5 if "friction" in path or path.endswith("load.damping") else 1.15
        assert ratio != 1.0 and 1.0 / most <= ratio <= most


@pytest.mark.parametrize(
    ("rig", "said"),
    [("hydrolek", "the two steps identify one"), ("emps", "'none'"), ("patu_lift", "Table 4.1")],
)
def test_other_rigs_are_refused(rig, said, capsys):
    assert run(["identify", "two-step", rig]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1


def test_a_holdout_without_recordings_is_refused():
    assert run(["identify", "two-step", "hydrolek_right_j2", "--holdout", "a.csv"]) == 2
    with pytest.raises(InputError, match="hydrolek_right_j2"):
        only_joint(load_rig("hydrolek"))


@pytest.mark.thorough
def test_both_steps_by_command_on_a_recording_of_a_changed_bench(tmp_path, capsys):
    """The bench stands for an arm: its rollouts are three times as fast."""
    pair = Path(__file__).parents[1] / "data" / "bench" / "practice_01"
    train, holdout = (
        write_recording(read_recording(pair / f"{part}.csv").between(0.0, end), tmp_path / f"{part}.csv")
        for part, end in (("train", 20.0), ("holdout", 10.0))
    )
    arguments = [str(train), "--holdout", str(holdout), "--starts", "1"]
    assert (
        run(
            [
                "identify",
                "two-step",
                "joint_bench",
                *arguments,
                "--no-polish",
                "--no-confirm",
                "--out",
                str(tmp_path),
            ]
        )
        == 0
    )
    content = json.loads((tmp_path / "two_step_joint.json").read_text())
    stages = {stage["name"]: stage for stage in content["stages"]}
    assert list(stages) == ["nominal", "step one, gain", "step one, hydraulics nominal", "step two"]
    # sixteen hydraulic parameters make up for most, but not all, of what differs in the others too
    assert stages["step two"]["held_out_deg"] < 0.5 * stages["nominal"]["held_out_deg"]
    assert stages["step two"]["held_out_deg"] < stages["step one, gain"]["held_out_deg"]
    again = load_rig(tmp_path / "rig_joint.yaml")
    for path, value in stages["step two"]["values"].items():
        assert again.value(path) == pytest.approx(value)
    held = {path: value for path, value in stages["step one, gain"]["values"].items() if ".load." in path}
    assert held
    for path, value in held.items():
        assert again.value(path) == pytest.approx(value)
    assert (tmp_path / "two_step_joint.png").read_bytes().startswith(b"\x89PNG")
