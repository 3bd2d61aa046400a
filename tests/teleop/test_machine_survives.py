"""The thread that keeps a task going outlives what goes wrong in it."""

import time

import pytest

from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Mode, Order
from hydrolek_drake.workcell.scene import home_posture


def _until(condition, limit=10.0):
    end = time.monotonic() + limit
    while not condition():
        assert time.monotonic() < end, f"did not happen within {limit:g} s"
        time.sleep(0.01)


@pytest.mark.parametrize("failure", [RuntimeError("broken"), MemoryError(), ValueError("shape")])
def test_a_failed_period_closes_the_valves_is_told_and_mends(failure):
    machine = Machine(home_posture(), realtime_rate=5.0)
    try:
        advance, failures = machine._arms.advance, [failure]

        def fails():
            if failures:
                raise failures.pop()
            return advance()

        machine._arms.advance = fails
        _until(lambda: "a period of the task failed" in machine.state().reason)
        assert not machine.state().valves_open
        _until(lambda: machine.state().reason == "")
        machine.order(Order.ABORT)
        assert machine.state().mode in (Mode.IDLE, Mode.ABORTED)
    finally:
        machine.close()
