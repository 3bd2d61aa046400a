"""`hydrolek teleop`: what cannot be served is one line and status 2."""

import socket

import pytest

from hydrolek_drake.cli.app import run


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--camera", "nowhere"], "is not a folder"),
        (["--camera", "live"], "no depth camera"),
        (["--camera", "nowhere", "--pipe-axis", "0", "0", "1"], "simulated camera's"),
        (["--controllers", "here"], "is no HOST:PORT"),
        (["--pipe-axis", "0", "0", "0"], "positive sizes"),
        (["--port", "70000"], "--port"),
        (["--plant", "steam"], "choose full or simple"),
        (["--set", "supply.pressure=12 MPa"], "--set is the full plant's"),
        (["--plant", "full", "--controller", "magic"], "no controller 'magic'"),
        pytest.param(
            ["--plant", "full", "--set", "supply.presure=12 MPa"],
            "supply.presure",
            marks=pytest.mark.thorough,
        ),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert run(["teleop", "--plant", "simple", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1


def test_controllers_that_do_not_answer_and_a_taken_port_are_told(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert run(["teleop", "--plant", "simple", "--port", str(port)]) == 2
        assert "choose another --port" in capsys.readouterr().err
    assert run(["teleop", "--controllers", f"127.0.0.1:{port}"]) == 2
    assert "no controllers answer" in capsys.readouterr().err
