"""The Jacobian against differentiation of (5.3), and thesis appendix D as printed against it."""

import json
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.kinematics.forward import tool_pose, wrist_position
from hydrolek_drake.kinematics.jacobian import tool_jacobian, wrist_jacobian

PRINTED = json.loads((Path(__file__).parents[1] / "data" / "appendix_d.json").read_text())["entries"]
# What docs/reference/thesis_errata.md says is meant: the same factors and signs, brackets where they belong
CORRECTED = {
    "y5": "C2 * (C3 * ((1424 * C5)/5 + (1847 * S5)/100) + C4 * S3 * ((1847 * C5)/100 - (1424 * S5)/5)) - "
    "S2 * (S3 * ((1424 * C5)/5 + (1847 * S5)/100) - C3 * C4 * ((1847 * C5)/100 - (1424 * S5)/5))",
    "z1": "S1 * S4 * ((1424 * C5)/5 + (1847 * S5)/100 + 889/20) - C1 * (C2 * (S3 * ((1847 * C5)/100 - "
    "(1424 * S5)/5 + 1063/5) + C3 * (C4 * ((1424 * C5)/5 + (1847 * S5)/100 + 889/20) + 165) + 13087/25) + "
    "S2 * (C3 * ((1847 * C5)/100 - (1424 * S5)/5 + 1063/5) - S3 * (C4 * ((1424 * C5)/5 + (1847 * S5)/100 + "
    "889/20) + 165)) + 70)",
    "z5": "S1 * (C2 * (S3 * ((1424 * C5)/5 + (1847 * S5)/100) - C3 * C4 * ((1847 * C5)/100 - (1424 * S5)/5)) + "
    "S2 * (C3 * ((1424 * C5)/5 + (1847 * S5)/100) + C4 * S3 * ((1847 * C5)/100 - (1424 * S5)/5))) - "
    "C1 * S4 * ((1847 * C5)/100 - (1424 * S5)/5)",
}


@pytest.fixture(scope="module")
def postures():
    return np.random.default_rng(54).uniform(-np.pi, np.pi, (200, 6))


def _numerical(function, angles, step=1e-6):
    columns = [(function(angles + step * e) - function(angles - step * e)) / (2 * step) for e in np.eye(6)]
    return np.stack(columns, axis=-1)


def test_wrist_jacobian_is_the_derivative_of_5_3(postures):
    numerical = _numerical(wrist_position, postures)
    np.testing.assert_allclose(wrist_jacobian(postures), numerical[..., :5], rtol=0, atol=1e-9)
    np.testing.assert_allclose(numerical[..., 5], 0.0, atol=1e-9)


def test_tool_jacobian_is_the_derivative_of_the_tools_pose(postures):
    jacobian = tool_jacobian(postures)
    position = _numerical(lambda q: tool_pose(q)[..., :3, 3], postures)
    np.testing.assert_allclose(jacobian[..., :3, :], position, rtol=0, atol=1e-9)
    turning = _numerical(lambda q: tool_pose(q)[..., :3, :3], postures)
    rotation = tool_pose(postures)[..., :3, :3]
    spin = np.einsum("nijk,nlj->nilk", turning, rotation)  # dR/dq R^T is skew: the angular velocity
    angular = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], axis=1)
    np.testing.assert_allclose(jacobian[..., 3:, :], angular, rtol=0, atol=1e-9)


@pytest.mark.parametrize("entry", [name for name in PRINTED if name not in CORRECTED])
def test_entry_of_appendix_d_is_right_as_printed(entry, postures):
    np.testing.assert_allclose(_evaluate(PRINTED[entry], postures), _ours(entry, postures), atol=1e-9)


@pytest.mark.parametrize("entry", CORRECTED)
def test_appendix_d_prints_three_entries_with_brackets_that_do_not_match(entry, postures):
    assert PRINTED[entry].count("(") != PRINTED[entry].count(")")
    with pytest.raises(SyntaxError):
        _evaluate(PRINTED[entry], postures)


@pytest.mark.parametrize("entry", CORRECTED)
def test_corrected_entry_is_right_and_moves_brackets_only(entry, postures):
    brackets = str.maketrans("", "", "() ")
    assert CORRECTED[entry].translate(brackets) == PRINTED[entry].translate(brackets)
    np.testing.assert_allclose(_evaluate(CORRECTED[entry], postures), _ours(entry, postures), atol=1e-9)


def test_wrong_shape_is_refused():
    with pytest.raises(InputError, match=r"\(5,\)"):
        tool_jacobian(np.zeros(5))


def _ours(entry, postures):
    """Our entry in mm/rad."""
    return 1e3 * wrist_jacobian(postures)[:, "xyz".index(entry[0]), int(entry[1]) - 1]


def _evaluate(formula, postures):
    names = {f"S{n}": np.sin(postures[:, n - 1]) for n in range(1, 6)}
    names |= {f"C{n}": np.cos(postures[:, n - 1]) for n in range(1, 6)}
    return np.broadcast_to(eval(formula, {"__builtins__": {}}, names), len(postures))
