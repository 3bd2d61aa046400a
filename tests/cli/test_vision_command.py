"""`hydrolek vision`: pictures and targets of one frame, or one line that says what is wrong."""

import cv2
import pytest

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
