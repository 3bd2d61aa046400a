"""`hydrolek vision`: pictures and targets of one frame, or one line that says what is wrong."""

import re

import cv2
import pytest
from casting import cast_crossing

from hydrolek_drake.cli.app import run


def test_targets_on_the_simulated_pipe(capsys, tmp_path):
    clicks = ["--click", "320", "240", "--grasp", "320", "200", "--cut", "320", "300"]
    assert run(["vision", "sim", *clicks, "--out", str(tmp_path)]) == 0
    text = capsys.readouterr().out
    assert "pipe: radius 3" in text and "cut end:" in text
    for name in ("colour", "edges", "object", "selected"):
        assert cv2.imread(str(tmp_path / f"{name}.png")).shape == (480, 640, 3)
    red = cv2.imread(str(tmp_path / "selected.png"))
    assert ((red == (0, 0, 255)).all(axis=-1)).sum() > 200


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sim", "--click", "10", "10"], "nothing within reach"),
        (["sim", "--fill", "magic"], "choose from surfaces, edges"),
        (["sim", "--grasp", "1", "1"], "--click, --grasp and --cut together"),
        (["nowhere"], "is not a folder"),
        (["live"], "no depth camera"),
        (["sim", "--sensitivity", "2"], "between 0 and 1"),
        (["sim", "--frame", "a"], "of a folder"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert run(["vision", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1


def test_an_unsure_object_is_told_and_the_other_can_be_taken(capsys, tmp_path):
    colour, depth, _, _ = cast_crossing(0.01)
    cv2.imwrite(str(tmp_path / "a_color.png"), colour)
    cv2.imwrite(str(tmp_path / "a_depth.png"), depth)
    click = ["vision", str(tmp_path), "--click", "100", "240"]
    assert run([*click, "--out", str(tmp_path / "out")]) == 0
    text = capsys.readouterr().out
    assert "Unsure of this outline" in text and "(--other 1)" in text
    size = int(re.search(r"object: (\d+) px", text)[1])
    other = int(re.search(r"other outline: (\d+) px", text)[1])
    assert not 0.6 < size / other < 1 / 0.6
    assert (cv2.imread(str(tmp_path / "out" / "other1.png")) == (0, 0, 255)).all(axis=-1).sum() > 200
    assert run([*click, "--other", "1"]) == 0
    assert f"object: {other} px" in capsys.readouterr().out
    assert run([*click, "--other", "2"]) == 2
    assert "has 1 other outline" in capsys.readouterr().err
