"""However often it is interrupted, serving the link closes the machine: an adapter's valves above all."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ADAPTER = """
import pathlib, numpy as np
FILE = pathlib.Path("{file}")


class Arms:
    period = 0.05

    def advance(self, order):
        FILE.with_suffix(".runs").write_text("")

    def measured(self):
        return np.zeros(14)

    def signals(self):
        return None

    def close(self):
        FILE.write_text("closed")


def adapter():
    return Arms()
"""


@pytest.mark.parametrize("signals", [(signal.SIGTERM,) * 2, (signal.SIGINT, signal.SIGTERM)])
@pytest.mark.parametrize("after_s", [0.0, 0.03])
def test_a_second_signal_does_not_keep_the_valves_from_being_closed(tmp_path, signals, after_s):
    closed = tmp_path / "closed"
    (tmp_path / "own_arms.py").write_text(ADAPTER.format(file=closed))
    process = subprocess.Popen(
        [Path(sys.executable).with_name("hydrolek"), "serve", "--adapter", "own_arms:adapter", "--port", "0"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        until = time.monotonic() + 60.0
        while not closed.with_suffix(".runs").exists():
            assert process.poll() is None and time.monotonic() < until
            time.sleep(0.02)
        for each in signals:
            process.send_signal(each)
            time.sleep(after_s)
        process.wait(60.0)
        assert closed.read_text() == "closed"
    finally:
        process.kill()
