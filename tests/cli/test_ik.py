"""`hydrolek ik`: angles that reach the target, or exit status 2 with the reason."""

import json

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame


def _angles(capsys, *arguments):
    assert run(["ik", *map(str, arguments), "--json"]) == 0
    return np.radians(json.loads(capsys.readouterr().out)["angles_deg"])


def test_position_in_millimetres(capsys):
    angles = _angles(capsys, "right", "--position", 900, 100, -50, "--unit", "mm")
    np.testing.assert_allclose(tool_pose(angles[0])[:3, 3], [0.9, 0.1, -0.05], rtol=0, atol=1e-9)


def test_world_frame_and_direction(capsys):
    angles = _angles(
        capsys, "left", "--position", 1.82, 0.3, 1.06, "--direction", 1, 0, 0, "--frame", "world"
    )
    tool = tool_pose(angles[0])
    reached = in_frame(tool[:3, 3], given_in="left_base", wanted_in="world")
    np.testing.assert_allclose(reached, [1.82, 0.3, 1.06], rtol=0, atol=1e-8)
    np.testing.assert_allclose(tool[:3, 0], [1.0, 0.0, 0.0], rtol=0, atol=1e-8)


def test_jacobian_transpose_keeps_its_tolerance(capsys):
    angles = _angles(
        capsys, "right", "--position", 0.8, 0.1, 0.1, "--method", "jacobian-transpose", "--tolerance-mm", 0.5
    )
    assert np.linalg.norm(tool_pose(angles[0])[:3, 3] - [0.8, 0.1, 0.1]) <= 0.5e-3


def test_table_shows_travel_and_cylinder(capsys):
    assert run(["ik", "right", "--position", "0.9", "0.1", "-0.05"]) == 0
    text = capsys.readouterr().out
    assert "right_j1" in text and "-27.00 to 40.60" in text and "posture 1 / deg" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["middle", "--position", "1", "0", "0"], "choose from right, left"),
        (["right", "--position", "3", "0", "0"], "long at most"),
        (["right", "--position", "0.1", "0", "0"], "stroke ends at"),
        (["right", "--position", ".9", ".3", ".1", "--direction", "-1", "0", "0"], "no joint angles give"),
        (["right", "--position", "1", "0", "0", "--unit", "kg"], "does not measure"),
        (["right", "--position", "1", "0", "0", "--frame", "moon"], "choose from right_base"),
        (["right", "--position", "1", "0", "0", "--method", "magic"], "choose from closed-form"),
        (["right", "--position", "1", "0", "0", "--jaw-axis", "0", "1", "0"], "needs --direction"),
        (["right", "--position", "3", "0", "0", "--method", "jacobian-transpose"], "is stuck"),
        (["right"], "--position"),
    ],
)
def test_what_cannot_be_is_one_line_and_status_2(arguments, message, capsys):
    assert run(["ik", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1
