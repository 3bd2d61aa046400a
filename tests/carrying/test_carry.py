"""Both arms carry a pipe: the plan by kinematics and collisions, and the full plant."""

import json

import numpy as np
import pytest

from hydrolek_drake.carrying.plan import Move, carry_entries, pipe_to_carry, plan_carry, pose_of
from hydrolek_drake.carrying.report import carried_figures, carried_png, plan_figures
from hydrolek_drake.carrying.simulation import simulate_carry
from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.chain import SIDES, joint_limits
from hydrolek_drake.workcell.closed_chain import chain_error, tools_at
from hydrolek_drake.workcell.collision import CollisionWorld
from hydrolek_drake.workcell.planner import path_is_free
from hydrolek_drake.workcell.trajectory import joint_speeds

pytestmark = pytest.mark.xdist_group("both arms")

UP = Move(np.array([0.0, 0.0, 0.08]), np.array([0.0, 0.0, 1.0]), 0.0)
TURNED = Move(np.array([0.0, 0.03, 0.04]), np.array([0.0, 0.0, 1.0]), np.radians(8.0))


@pytest.fixture(scope="module")
def plan():
    return plan_carry(pipe_to_carry(), TURNED, np.random.default_rng(1))


def test_the_planned_way_carries_the_pipe_where_it_is_wanted(plan):
    path = TURNED.path(pose_of(plan.pipe))
    trajectory = plan.trajectory()
    for time, pose in ((0.0, path[0]), (trajectory.end_time(), path[-1])):
        right, left = tools_at([trajectory.value(time)[:, 0]])
        np.testing.assert_allclose(right[0] @ np.linalg.inv(plan.hold.right), pose, atol=1e-6)
        np.testing.assert_allclose(left[0] @ np.linalg.inv(plan.hold.left), pose, atol=1e-6)


def test_between_the_solved_postures_the_chain_stays_closed_within_limits_and_speeds(plan):
    trajectory, speed = plan.trajectory(), joint_speeds()[0]
    lower, upper = (np.concatenate([joint_limits(side)[i] for side in SIDES]) for i in (0, 1))
    times = np.linspace(0.0, trajectory.end_time(), 300)
    postures = np.array([trajectory.value(time)[:, 0] for time in times])
    error, turn = chain_error(postures, plan.hold)
    assert error.max() < 1e-4 and turn.max() < 1e-4  # a fiftieth of what the joints' control is off
    assert np.all(postures >= lower - 1e-9) and np.all(postures <= upper + 1e-9)
    for time in times:
        assert np.all(np.abs(trajectory.EvalDerivative(time, 1)[:, 0]) <= speed * (1 + 1e-9))
    hands = np.stack(tools_at(postures))[:, :, :3, 3]
    faster = np.linalg.norm(np.diff(hands, axis=1), axis=2) / np.diff(times)
    assert faster.max() < 1.05 * carry_entries("move")["speed"]


def test_nothing_touches_on_the_way_there_nor_with_the_pipe(plan):
    held = CollisionWorld(plan.pipe, padding=0.0, holding=SIDES)
    assert path_is_free(held, list(plan.approach))
    assert CollisionWorld(plan.pipe, padding=0.0).free(plan.approach[0])
    path = TURNED.path(pose_of(plan.pipe))
    for pose, posture in zip(path, plan.postures, strict=True):
        turn = pose[:3, :3] @ path[0][:3, :3].T
        held.put(plan.pipe.moved(turn, pose[:3, 3] - turn @ plan.pipe.point), ())
        assert held.free(posture)


def test_a_way_that_no_grasp_allows_is_refused_with_the_reason():
    with pytest.raises(InputError, match=r"no pair of grasps can move the pipe so: after \d+ % of the way"):
        plan_carry(pipe_to_carry(), Move(np.array([0.0, 0.9, 0.0]), UP.axis, 0.0), np.random.default_rng(1))
    with pytest.raises(InputError, match="beyond its ends"):
        plan_carry(pipe_to_carry(), UP, np.random.default_rng(1), apart=0.6)


def test_the_command_plans_and_tells_json(tmp_path, capsys):
    assert run(["carry", "--plant", "none", "--json", "--out", str(tmp_path)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["plan"]["chain_error_mm"] < 0.1 and found["plan"]["joint_margin_deg"] > 0.0
    assert json.loads((tmp_path / "carry.json").read_text()) == found


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--plant", "half"], "choose full or none"),
        (["--controller", "none"], "no controller"),
        (["--turn", "5", "--turn-axis", "0", "0", "0"], "axis without length"),
        (["--pipe-length", "-1"], "positive sizes"),
        (["--pipe-point", "9", "0", "1"], "cannot grasp there"),
    ],
)
def test_bad_options_are_refused_in_one_line(capsys, arguments, said):
    assert run(["carry", *arguments]) == 2
    printed = capsys.readouterr().err.splitlines()
    assert said in printed[-1] and printed[-1].startswith("hydrolek: ")


@pytest.mark.long("half a minute: step tests of all joints, then the plant")
def test_the_full_plant_carries_the_pipe_in_both_hands():
    plan = plan_carry(pipe_to_carry(), UP, np.random.default_rng(1))
    carried = simulate_carry(plan)
    figures = carried_figures(carried)
    assert figures["chain_error_mm"] < figures["tolerance_mm"]
    assert figures["friction_used"] < 1.0 and figures["least_grip_N"] > 1e3
    assert figures["pipe_off_at_the_end_mm"] < figures["tolerance_mm"]
    moved = carried.pipe_place[-1, :3] - carried.pipe_place[0, :3]
    np.testing.assert_allclose(moved, UP.shift, atol=5e-3)
    # the set points themselves keep the hold; what is off is the joints' control
    assert carried.wanted_error[:, 0].max() < 0.1 * carried.chain_error[:, 0].max()
    assert carried_png(plan, carried).startswith(b"\x89PNG")
    header, *rows = carried.csv().splitlines()
    assert len(rows) == len(carried.time) and header.startswith("time_s,")
    assert plan_figures(plan)["duration_s"] == pytest.approx(plan.trajectory().end_time())
