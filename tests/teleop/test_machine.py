"""Sequencer, link and arms together, faster than real time."""

import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.arms_end import ArmsEnd
from hydrolek_drake.teleop.controllers.serving import Pacer
from hydrolek_drake.teleop.link.server import SetpointServer
from hydrolek_drake.teleop.link.signals import Signals
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Mode, Order
from hydrolek_drake.workcell.scene import home_posture


@pytest.fixture
def machine():
    machine = Machine(home_posture(), realtime_rate=25.0)
    yield machine
    machine.close()


def _until(condition, seconds=20.0):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, f"did not happen within {seconds} s"
        time.sleep(0.01)


def test_the_arms_do_the_whole_task(machine, plan):
    machine.start(plan)
    _until(lambda: machine.state().mode is not Mode.RUNNING)
    state = machine.state()
    assert state.mode is Mode.DONE
    trajectory = plan.steps[-1].trajectory
    np.testing.assert_allclose(
        state.position, trajectory.value(trajectory.end_time())[:, 0], atol=np.radians(1.0)
    )


def _stands_until_resumed(machine):
    """A stopped machine does not move; resumed, it finishes its task."""
    where = machine.state().position
    time.sleep(0.3)
    state = machine.state()
    assert state.mode is Mode.STOPPED and not state.valves_open
    np.testing.assert_allclose(state.position, where, atol=np.radians(0.1))
    machine.order(Order.RESUME)
    _until(lambda: machine.state().mode is not Mode.RUNNING)
    assert machine.state().mode is Mode.DONE


def test_stop_stands_still_at_any_moment_and_the_task_is_finished_after_a_resume(machine, plan):
    machine.start(plan)
    time.sleep(0.1)
    machine.order(Order.STOP)
    _stands_until_resumed(machine)


def test_a_lost_link_stops_the_task(plan):
    arms = ArmsEnd(home_posture())
    machine = Machine(
        home_posture(), controllers=("127.0.0.1", arms.server.port), token=arms.token, realtime_rate=5.0
    )
    machine.start(plan)
    time.sleep(0.2)
    arms.server.close()
    _until(lambda: machine.state().reason != "")
    _until(lambda: machine.state().mode is Mode.STOPPED)
    assert not machine.state().valves_open and "link:" in machine.state().reason
    with pytest.raises(InputError, match="link:"):
        machine.order(Order.RESUME)
    assert not arms.server.command()[1]
    machine.close()


def test_a_link_that_comes_back_moves_nothing_until_the_operator_resumes(machine, plan, monkeypatch):
    stall, answer = threading.Event(), machine._arms.server.answer

    def slow(client, line):
        if stall.is_set():
            stall.clear()
            time.sleep(1.5 * teleop_entries("link")["silence"])
        return answer(client, line)

    monkeypatch.setattr(machine._arms.server, "answer", slow)
    machine.order(Order.STOP)  # by an operator who presses it before anything moves
    machine.start(plan)
    _until(lambda: machine.state().step == "grasp")
    stall.set()
    _until(lambda: machine.state().reason != "")
    assert "link: lost" in machine.state().reason and not machine.state().valves_open
    _until(lambda: machine.state().reason == "")
    _stands_until_resumed(machine)


def test_a_slow_plant_gets_every_set_point_of_a_task_once(plan):
    rate, samples, ended = 5.0, [], threading.Event()
    server = SetpointServer(home_posture(), port=0, realtime_rate=rate)
    nothing = {name: np.zeros(14) for name in ("voltage", "pressure_a", "pressure_b", "potentiometer")}

    def simulate():
        count = 0
        while not ended.is_set():
            if not server.message_came.wait(0.1):
                continue
            server.message_came.clear()
            order = server.order()
            time.sleep(0.03)  # three periods for each sample
            if order.valves_open:
                samples.append(order.desired)
            count += 1
            time_s = 0.05 * count
            server.report(
                order.desired, Signals(time=time_s, supply_pressure=0.0, grip=np.zeros(2), **nothing)
            )

    threading.Thread(target=simulate, daemon=True).start()
    server.report(home_posture(), Signals(time=0.0, supply_pressure=0.0, grip=np.zeros(2), **nothing))
    machine = Machine(
        home_posture(),
        plant=SimpleNamespace(port=server.port, token=None, close=lambda: None),
        realtime_rate=rate,
    )
    try:
        machine.start(plan)
        _until(lambda: len(samples) >= 30)
    finally:
        ended.set()
        machine.close()
        server.close()
    period, path = teleop_entries("task")["period"], plan.steps[0].trajectory
    wanted = [path.value(period * k)[:, 0] for k in range(40)]
    first = int(np.argmin([np.abs(samples[0] - w).max() for w in wanted]))
    np.testing.assert_allclose(samples[:25], wanted[first : first + 25], atol=np.radians(1e-3))


def test_a_plant_waits_for_late_messages_and_not_for_none():
    server = SimpleNamespace(message_came=threading.Event())
    pacer, counts, waited = Pacer(server, sample_s(), 0.25), [], []

    def simulate():
        while len(waited) < 12:
            pacer.wait()
            waited.append(time.monotonic())

    plant = threading.Thread(target=simulate, daemon=True)
    plant.start()
    for _ in range(6):
        server.message_came.set()
        time.sleep(0.5)  # two and a half periods, less than the patience
        counts.append(len(waited))
    np.testing.assert_array_equal(np.diff(counts[1:]), 1)
    plant.join(timeout=20.0)
    assert len(waited) == 12
