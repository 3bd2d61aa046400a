"""Scenario files: what they say, what is refused, and every one that comes with the project."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, write_recording
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.runs.running import run_scenario
from hydrolek_drake.scenarios.commands import RandomLevels
from hydrolek_drake.scenarios.scenario import load_scenario, scenario_files

BENCH = """schema: 1
rig: joint_bench
duration: 1 s
command: {kind: constant, joints: {joint: 2 V}}
"""


@pytest.mark.parametrize("name", sorted(scenario_files()))
def test_every_scenario_runs(name):
    scenario = load_scenario(name, {"scenario.duration": "0.2 s"})
    run = run_scenario(scenario).run
    assert run.time[-1] == pytest.approx(0.2)
    assert run.signals["position"].shape == (21, len(scenario.rig.joints))
    assert all(np.isfinite(values).all() for values in run.signals.values())


def test_scenarios_that_the_project_promises():
    promised = {"step_one_joint", "random_one_joint", "both_arms", "gravity_hold", "hose_burst"}
    assert promised <= set(scenario_files())
    assert len(load_scenario("both_arms").rig.joints) == 14
    values = load_scenario("both_arms").command_table()[1]
    assert (np.ptp(values, axis=0) > 0.0).all()  # every function moves


def test_units_and_plain_numbers_mean_the_same(scenario_file):
    a = load_scenario(scenario_file(BENCH))
    b = load_scenario(scenario_file(BENCH.replace("1 s", "1000 ms").replace("2 V", "2")))
    assert a.duration == b.duration == 1.0
    assert a.command_table()[1] == pytest.approx(b.command_table()[1])


def test_steps_hold_until_the_next(scenario_file):
    text = BENCH.replace(
        "kind: constant, joints: {joint: 2 V}", "kind: steps, joints: {joint: [[0.2 s, 2 V], [0.5 s, -1 V]]}"
    )
    times, values = load_scenario(scenario_file(text)).command_table()
    assert times.tolist() == [0.0, 0.2, 0.5, 1.0]
    assert values[:, 0].tolist() == [0.0, 2.0, -1.0, -1.0]


def test_commands_zero_at_overrides_the_command(scenario_file):
    path = scenario_file(BENCH + "events: {commands_zero_at: 0.4 s}\n")
    times, values = load_scenario(path).command_table()
    assert (times[-1], values[-1, 0]) == (0.4, 0.0)
    assert (values[times < 0.4, 0] == 2.0).all()


def test_random_levels_are_seeded_held_and_within_bounds():
    kind = RandomLevels(np.array([True, True, False]), np.zeros(3), 3.0, 5, (0.2, 0.6), 1)
    times, values = kind.table(60.0, 0.01, None)
    again = kind.table(60.0, 0.01, None)[1]
    other = kind.table(60.0, 0.01, 2)[1]
    assert np.array_equal(values, again)
    assert values.shape != other.shape or not np.array_equal(values, other)
    assert set(np.unique(values[:, 0])) == {-3.0, -1.5, 0.0, 1.5, 3.0}
    assert (values[:, 2] == 0.0).all() and not np.array_equal(values[:, 0], values[:, 1])
    changes = times[1:][np.diff(values[:, 0]) != 0.0]
    assert np.diff(changes).min() > 0.2 - 0.01 and np.allclose(times / 0.01, np.round(times / 0.01))


def test_recorded_command_is_played_back(scenario_file, tmp_path):
    time = 5.0 + 0.01 * np.arange(101)  # need not begin at zero
    volts = np.where(time < 5.5, 1.0, -2.0)
    write_recording(
        Recording("r", time, {"joint.command": volts, "joint.angle": np.zeros(101)}, tmp_path),
        tmp_path / "recorded.csv",
    )
    text = BENCH.replace("kind: constant, joints: {joint: 2 V}", "kind: recording, path: recorded.csv")
    times, values = load_scenario(scenario_file(text)).command_table()
    assert times[0] == 0.0 and times[-1] == pytest.approx(1.0)
    assert values[times < 0.4999, 0].tolist() == [1.0] * 50
    assert (values[times > 0.4999, 0] == -2.0).all()


def test_settings_reach_scenario_and_rig():
    settings = {
        "scenario.duration": "2",
        "scenario.command.joints.right_j2": "[[0 s, 1 V]]",
        "scenario.initial_position.right_j3": "0 deg",
        "supply.pressure": "12 MPa",
    }
    scenario = load_scenario("step_one_joint", settings)
    assert scenario.duration == 2.0
    assert scenario.command_table()[1][-1, 0] == 1.0
    assert scenario.rig.value("supply.pressure") == 12e6
    # a held joint's position changes the load: straight forward, the arm weighs more than as the rig holds it
    held = load_rig("hydrolek_right_j2")
    assert scenario.rig.held["right_j3"] == 0.0
    assert scenario.rig.value("load.gravity_cos") > held.value("load.gravity_cos")


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("schema: 1", "schema: 9", ["schema: '9'", "schema: 1"]),
        ("rig: joint_bench", "rig: joint_bnch", ["mine.yaml: rig", "did you mean joint_bench"]),
        ("duration: 1 s", "duration: 1 m", ["mine.yaml: duration", "'m'"]),
        ("duration: 1 s", "duration: -1", ["mine.yaml: duration", "impossible"]),
        ("duration: 1 s", "duraton: 1 s", ["mine.yaml.duraton", "did you mean duration"]),
        ("duration: 1 s\n", "", ["duration is missing"]),
        ("kind: constant", "kind: sine", ["'sine'", "constant, steps, random, recording, controlled"]),
        ("joint: 2 V", "elbow: 2 V", ["command.joints.elbow", "choose joint"]),
        ("joint: 2 V", "joint: 2 MPa", ["command.joints.joint", "'MPa'"]),
        (
            "kind: constant, joints: {joint: 2 V}",
            "kind: steps, joints: {joint: 2 V}",
            ["list of [time, value]"],
        ),
        (
            "kind: constant, joints: {joint: 2 V}",
            "kind: steps, joints: {joint: [[1 s, 2 V], [1 s, 0 V]]}",
            ["joint[1]", "does not come after 1 s"],
        ),
        (
            "kind: constant, joints: {joint: 2 V}",
            "kind: random, amplitude: 3 V, levels: 1, hold: [0.2 s, 1 s]",
            ["levels: '1'", "2 or more"],
        ),
        (
            "kind: constant, joints: {joint: 2 V}",
            "kind: random, amplitude: 3 V, levels: 5, hold: [1 s, 0.2 s]",
            ["command.hold", "shorter to a longer"],
        ),
        (
            "kind: constant, joints: {joint: 2 V}",
            "kind: recording, path: none.csv",
            ["none.csv does not exist"],
        ),
        (
            "kind: constant,",
            "kind: constant, operator: true,",
            ["command.joints.joint", "not a signal in percent"],
        ),
        ("rig: joint_bench", "rig: joint_bench\nforces: torques", ["forces: 'torques'", "mounts or moments"]),
        ("rig: joint_bench", "rig: joint_bench\nnoise: 3", ["noise: '3'"]),
        ("rig: joint_bench", "rig: joint_bench\nevents: {hose: 1}", ["events.hose", "supply_lost_at"]),
        (
            "rig: joint_bench",
            "rig: joint_bench\ninitial_position: {joint: 90 deg}",
            ["outside its stops", "65.6"],
        ),
        (
            "rig: joint_bench",
            "rig: joint_bench\ninitial_position: {elbow: 1}",
            ["initial_position.elbow", "joint"],
        ),
        (
            "rig: joint_bench",
            "rig: joint_bench\nsettings: {supply.presure: 1}",
            ["settings", "supply.pressure"],
        ),
        ("rig: joint_bench", "rig: joint_bench\nintegration: {step: 0}", ["integration.step", "above 0"]),
        (
            "rig: joint_bench",
            "rig: joint_bench\nintegration: {integrator: euler}",
            ["'euler'", "runge_kutta2"],
        ),
    ],
)
def test_wrong_files_are_refused_in_one_line(scenario_file, old, new, expected):
    text = BENCH.replace(old, new)
    assert text != BENCH
    with pytest.raises(InputError) as refusal:
        load_scenario(scenario_file(text)).command_table()
    message = str(refusal.value)
    assert "\n" not in message and all(part in message for part in expected), message


@pytest.mark.parametrize(
    ("settings", "expected"),
    [
        ({"scenario.duraton": "5"}, "did you mean duration"),
        ({"scenario.command.kind": "sine"}, "choose constant"),
        ({"scenario.title.x": "5"}, "no keys below"),
        ({"suply.pressure": "5"}, "supply.pressure"),
    ],
)
def test_wrong_settings_are_refused(settings, expected):
    with pytest.raises(InputError, match=expected):
        load_scenario("random_one_joint", settings)
