"""`hydrolek serve`: console and controllers on two machines, and every way to end it closes the valves."""

import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.cli.app import run
from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.controllers.adapter import Arms, load_adapter
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.workcell.scene import home_posture

_EXAMPLES = Path(__file__).parents[2] / "docs" / "examples"

_LOGGING = """
import sys
sys.path.insert(0, {examples!r})
from machine_adapter import Machine as Example

class Machine(Example):
    def write(self, voltages):
        super().write(voltages)
        with open({log!r}, "a") as log:
            log.write(f"{{abs(voltages).max():.3f}}\\n")

    def close(self):
        super().close()
        with open({log!r}, "a") as log:
            log.write("closed\\n")
"""


class _Served:
    """`hydrolek serve` in a process of its own."""

    def __init__(self, *arguments):
        program = "import sys; from hydrolek_drake.cli.app import main; sys.argv[1:] = ['serve', *sys.argv[1:]]; main()"
        self.process = subprocess.Popen(
            [sys.executable, "-c", program, "--port", "0", *arguments],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"},
        )
        line = self.process.stdout.readline()
        found = re.search(r"listens at \S+:(\d+)", line)
        assert found, line + self.process.stderr.read()
        self.port = int(found[1])

    def end(self, how=signal.SIGINT):
        self.process.send_signal(how)
        status = self.process.wait(20.0)
        return status, self.process.stderr.read()


@pytest.fixture
def logged(tmp_path):
    log = tmp_path / "log.txt"
    log.touch()
    adapter = tmp_path / "logged_machine.py"
    adapter.write_text(_LOGGING.format(examples=str(_EXAMPLES), log=str(log)))
    return adapter, log


def _until(condition, limit=10.0):
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, f"did not happen within {limit:g} s"
        time.sleep(0.02)


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_an_own_machine_follows_set_points_and_its_valves_close_at_the_end(logged, how):
    adapter, log = logged
    served = _Served("--adapter", f"{adapter}:Machine")
    try:
        client = SetpointClient(served.port)
        wanted = home_posture() + 0.02

        def there():
            return np.allclose(client.send(wanted), wanted, atol=np.radians(0.2))

        _until(there)
    finally:
        status, error = served.end(how)
    assert status == 130 and error.strip() == "hydrolek: interrupted"
    lines = log.read_text().split()
    assert lines[-2:] == ["0.000", "closed"] and max(map(float, lines[:-1])) > 0.3


def test_a_machine_that_fails_is_one_line_and_its_valves_close(logged, tmp_path):
    adapter, log = logged
    adapter.write_text(
        adapter.read_text()
        + "    def advance(self, order):\n"
        + "        if order.valves_open:\n"
        + "            raise OSError('the field point does not answer')\n"
    )
    served = _Served("--adapter", f"{adapter}:Machine")
    client = SetpointClient(served.port)
    client.send(home_posture())
    assert served.process.wait(20.0) == 2
    error = served.process.stderr.read().strip()
    assert "the field point does not answer" in error and len(error.splitlines()) == 1
    assert log.read_text().split()[-2:] == ["0.000", "closed"]
    with pytest.raises(InputError):
        client.send(home_posture())


def test_the_console_s_machine_drives_it_from_another_process():
    served = _Served("--plant", "simple", "--token", "a-token-that-is-long")
    try:
        with pytest.raises(InputError, match="TOKEN"):
            Machine(home_posture(), controllers=("127.0.0.1", served.port))
        machine = Machine(
            home_posture(), controllers=("127.0.0.1", served.port), token="a-token-that-is-long"
        )
        begin = machine.state().position[0]
        wish = np.array([50.0, *[0.0] * 13])

        def moved():
            machine.move_by_hand(deflection=wish)
            return machine.state().position[0] > begin + 0.02

        _until(moved)
        machine.order(Order.STOP)
        _until(lambda: not machine.state().valves_open)
        machine.close()
    finally:
        served.end()


def test_the_session_of_the_documentation():
    served = _Served("--plant", "simple")
    try:
        client = SetpointClient(served.port)
        for line in (_EXAMPLES / "link_session.txt").read_text().splitlines():
            if line.startswith(">"):
                answer = client._ask(line[2:].encode() + b"\n").decode()
            elif line == "< ...":
                assert len([float(word) for word in answer.split(",")]) == 14
            elif line.startswith("<"):
                assert answer == line[2:]
    finally:
        served.end()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--plant", "steam"], "choose full or simple"),
        (["--token", "short"], "at least 16"),
        (["--token", "two words of which"], "one word"),
        (["--adapter", "nothing"], "MODULE:NAME"),
        (["--adapter", "nowhere.py:Machine"], "no such file"),
        (["--adapter", "no_such_module_here:Machine"], "no_such_module_here"),
        (["--adapter", "json:Machine"], "nothing to call by the name 'Machine'"),
        (["--adapter", "json:dumps"], "TypeError"),
        (["--adapter", "io:StringIO"], "no 'period'"),
        (["--plant", "simple", "--set", "supply.pressure=12 MPa"], "--set is the full plant's"),
        (["--set", "supply.presure=12 MPa"], "supply.presure"),
        (["--rig", "joint_bench"], "is not both arms"),
        (["--controller", "magic"], "no controller 'magic'"),
        (["--plant", "simple", "--host", "no.such.name.invalid"], "cannot listen"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert run(["serve", "--port", "0", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and len(error.strip().splitlines()) == 1


def test_the_example_is_a_machine():
    arms = load_adapter(f"{_EXAMPLES / 'machine_adapter.py'}:Machine")
    assert isinstance(arms, Arms)
    np.testing.assert_allclose(arms.measured(), home_posture(), atol=1e-9)
