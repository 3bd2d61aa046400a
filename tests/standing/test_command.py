"""`hydrolek stand`: bad input is one line and exit status 2; and the place is one that the console plans from."""

import pytest

from hydrolek_drake.cli.app import run


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("grasp: 3", "beyond its end"),
        ("grasp: 0.1\ncut: 0.1", "where it is held"),
        ("pipe: {point: [2, 0, 0.3]}", "into the floor"),
        ("pipe: {axis: [0, 0, 0]}", "positive sizes"),
        ("pipe: {point: [2, 0]}", "three numbers"),
        ("tables: []", "unknown"),
        ("blocks: [{name: a, middle: [0, 0, 0]}]", "size is missing"),
        ("blocks: [{name: right_wall, middle: [0, 0, 0], size: [1, 1, 1]}]", "does not begin with"),
        ("blocks: [{name: a, middle: [0, 0, 0], size: [1, 0, 1]}]", "positive lengths"),
        (
            "blocks: [{name: a, middle: [9, 9, 9], size: [1, 1, 1]}, {name: a, middle: [9, 9, 9], size: [1, 1, 1]}]",
            "name of its own",
        ),
        ("blocks: [{name: ' ', middle: [9, 9, 9], size: [1, 1, 1]}]", "give a name"),
        ("grasp: .inf", "finite"),
        ("- 1", "give pipe"),
        ("pipe: {length: 1.0e+300}", "beyond 100 m"),
        ("pipe: {point: [1.0e+200, 0, 1]}", "beyond 100 m"),
    ],
)
def test_a_bad_site_is_refused_in_one_line(tmp_path, capsys, text, said):
    path = tmp_path / "site.yaml"
    path.write_text(text)
    assert run(["stand", str(path)]) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1 and said in printed.err and printed.out == ""


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["stand", "--grasping", "both"], "choose from right, left, either"),
        (["stand", "nowhere.yaml"], "cannot be read"),
        (["stand", "--base", "nowhere.yaml"], "cannot be read"),
        (["teleop", "--stand", "nowhere.json"], "cannot be read"),
        (["teleop", "--stand", "a.json", "--loose"], "leave the others out"),
    ],
)
def test_bad_options_are_refused_in_one_line(capsys, arguments, said):
    assert run(arguments) == 2
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1 and said in printed.err


def test_a_pipe_under_the_roof_has_no_place(tmp_path, capsys):
    base = tmp_path / "base.yaml"
    base.write_text(
        "tracks: {heading: {value: [0, 0], unit: deg}}\nboom: {angle: {value: [40, 50], unit: deg}}"
    )
    assert run(["stand", "--pipe-point", "2", "0", "3.5", "--base", str(base), "--out", str(tmp_path)]) == 2
    printed = capsys.readouterr()
    assert "no place found" in printed.err and "long at most" in printed.err
    assert (tmp_path / "stand.png").stat().st_size > 1000
