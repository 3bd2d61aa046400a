"""The hydraulic plant in its own process behind the link: the task, and every way to lose the operator."""

import time

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.controllers.plant_process import PlantProcess
from hydrolek_drake.teleop.hand import within_limits
from hydrolek_drake.teleop.link.client import SetpointClient
from hydrolek_drake.teleop.link.messages import encode, encode_rate
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.release import plan_release
from hydrolek_drake.teleop.sequencer import Mode, Order
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture

pytestmark = pytest.mark.xdist_group(
    "console on the hydraulic plant"
)  # two plants at once fall behind the clock

STILL = np.radians(1.0)  # tolerance of the task: trapped oil still swings a little, and readings have noise
PATIENCE = 120.0  # s; on a busy computer the task waits for the plant
DEAD_TIME = 0.5  # s: joint 4's dead time of 0.24 s, and until its oil is at rest


@pytest.fixture(scope="module")
def plant():
    """One for all, which takes a while to start: the last test kills it."""
    plant = PlantProcess(home_posture(), pipe=make_pipe())
    yield plant
    plant.close()
    assert not plant.running()


def _until(condition, seconds=PATIENCE):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, f"did not happen within {seconds} s"
        time.sleep(0.02)


def _watch(plant):
    """A client that asks for signals alone, which opens no valve."""
    client = None
    limit = time.monotonic() + PATIENCE
    while client is None:
        assert time.monotonic() < limit
        time.sleep(0.05)
        client = SetpointClient(plant.port, token=plant.token)
        try:
            client.signals()
        except InputError:  # the one before is still being missed
            client.close()
            client = None
    return client


def _pass(clock, seconds):
    """Wait until so much of the plant's own time has passed, which a busy computer holds up."""
    end = clock() + seconds
    _until(lambda: clock() >= end)


def _clock(client):
    return lambda: client.signals().time


def _stands_still(plant):
    client = _watch(plant)
    _pass(_clock(client), DEAD_TIME)
    np.testing.assert_array_equal(client.signals().voltage, 0.0)
    before = client.stop()
    _pass(_clock(client), 0.5)
    np.testing.assert_allclose(client.stop(), before, atol=STILL)
    np.testing.assert_array_equal(client.signals().voltage, 0.0)
    client.close()


def _move(client, send, seconds=1.0):
    """Keep sending for so much of the plant's time; returns how far the joints came."""
    first = last = send()
    end = client.signals().time + seconds
    while client.signals().time < end:
        time.sleep(0.05)
        last = send()
    return np.degrees(np.abs(last - first).max())


@pytest.mark.parametrize(
    "message",
    [b"hello\n", b"1,2,3\n", b"9" * 2000 + b"\n", b"RATE,1,2\n", b"RATE" + b",101" * 14 + b"\n", b"STOP\n"],
)
@pytest.mark.thorough
def test_a_bad_message_or_a_stop_closes_the_valves_of_a_moving_machine(plant, message):
    client = _watch(plant)
    away = home_posture() + np.radians(4.0) * np.sign(home_posture()[0] - client.stop()[0] + 1e-9)
    assert _move(client, lambda: client.send(away)) > 1.0
    client._socket.sendall(message)
    time.sleep(0.1)
    client.close()
    _stands_still(plant)


@pytest.mark.thorough
def test_a_client_that_leaves_or_falls_silent_closes_the_valves_of_a_moving_machine(plant):
    deflection = np.zeros(14)
    for sign, leaves in ((30.0, True), (-30.0, False)):
        deflection[[0, 8]] = sign
        client = _watch(plant)
        assert _move(client, lambda client=client: client.rate(deflection)) > 2.0
        if leaves:
            client.close()
        else:
            time.sleep(teleop_entries("link")["silence"])
            client.close()
        _stands_still(plant)


@pytest.mark.thorough
def test_asking_for_signals_is_no_sign_of_life(plant):
    client = _watch(plant)
    deflection = np.zeros(14)
    deflection[0] = -20.0
    client.rate(deflection)
    _until(lambda: client.signals().voltage.any())
    _until(lambda: not client.signals().voltage.any())
    client.close()


@pytest.mark.thorough
def test_the_plant_keeps_to_the_clock_or_tells_its_pace(plant):
    client = _watch(plant)
    begin, first = time.monotonic(), client.signals().time
    paces = []
    for _ in range(40):
        client.stop()
        time.sleep(0.05)
        paces.append(client.signals().pace)
    passed = time.monotonic() - begin
    ran = client.signals().time - first
    assert min(paces) * passed - 0.15 < ran < passed + 0.15  # a busy computer may hold it up
    for _ in range(200):  # a flood of messages does not make it run ahead
        client.send(within_limits(client.stop()))
    assert client.signals().time - first < time.monotonic() - begin + 0.2
    client.close()


def test_what_the_plant_refuses_is_told_in_one_line():
    with pytest.raises(InputError, match=r"supply\.presure"):
        PlantProcess(home_posture(), settings={"supply.presure": "12 MPa"})


def test_rates_as_text():
    assert encode_rate(np.full(14, 12.34)).startswith(b"RATE,12.3,12.3")
    assert len(encode(home_posture())) < teleop_entries("link")["longest_message"]


@pytest.mark.long("45 s: the whole task on the hydraulic plant")
def test_the_task_with_a_stop_and_a_resume_the_release_of_a_held_pipe_and_a_plant_that_dies(plant, plan):
    client = _watch(plant)
    _move(client, lambda: client.send(home_posture()), 2.0)  # where the plan begins
    client.close()
    time.sleep(0.3)  # until the plant has noticed
    machine = Machine(home_posture(), plant=plant)

    def clock():
        return machine.state().signals.time

    try:
        machine.start(plan)
        _pass(clock, 1.5)
        with pytest.raises(InputError, match="abort it before"):
            machine.move_by_hand(deflection=np.full(14, 20.0))
        machine.order(Order.STOP)
        _pass(clock, DEAD_TIME)
        state = machine.state()
        assert state.mode is Mode.STOPPED and not state.valves_open
        np.testing.assert_array_equal(state.signals.voltage, 0.0)
        _pass(clock, 0.5)
        np.testing.assert_allclose(machine.state().position, state.position, atol=STILL)
        machine.order(Order.RESUME)
        _until(lambda: machine.state().mode is not Mode.RUNNING)
        state = machine.state()
        assert state.mode is Mode.DONE
        end = plan.steps[-1].trajectory
        off = np.abs(state.position - end.value(end.end_time())[:, 0])[plan.steps[-1].watched]
        assert off.max() < np.radians(teleop_entries("task")["tolerance_deg"])
        assert state.signals.grip[0] > 1e3 and np.degrees(state.position[6]) > 10.0
        machine.start(plan_release(plan, within_limits(state.position), np.random.default_rng(1)))
        _until(lambda: machine.state().mode is not Mode.RUNNING)
        state = machine.state()
        assert state.mode is Mode.DONE
        np.testing.assert_allclose(state.position, home_posture(), atol=np.radians(1.3))  # and noise
        np.testing.assert_array_equal(state.signals.grip, 0.0)
        plant._process.kill()
        _until(lambda: machine.state().reason != "", 3.0)
        assert "link:" in machine.state().reason and not machine.state().valves_open
        with pytest.raises(InputError, match="link:"):
            machine.move_by_hand(deflection=np.full(14, 20.0))
    finally:
        machine.close()
