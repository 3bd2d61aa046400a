"""Pick and place at the console without a browser, on the simple arms: the pipe moves, and is seen where it was put."""

import time

import numpy as np
import pytest
from loose_pipe_scene import GRASP, PIPE, PLACE, RAISED, TABLE, pixel

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.place_plan import PLACE_STEPS
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands


@pytest.fixture
def machine(request):
    rate = getattr(request, "param", 25.0)
    machine = Machine(home_posture(), realtime_rate=rate, pipe=PIPE, table=TABLE)
    yield machine
    machine.close()


@pytest.fixture
def session(machine):
    session = OperatorSession(
        lambda: SimulatedKinect(PIPE, np.random.default_rng(1), table=TABLE),
        machine,
        seed=1,
        stand=as_machine_stands,
    )
    session.set_task("place")
    yield session
    session.close()


def _until(condition, seconds=180.0):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, f"did not happen within {seconds} s"
        time.sleep(0.01)


def _click(session, *points):
    for point in points:
        session.click(*pixel(point))


def _click_all(session):
    session.snapshot()
    _click(session, RAISED, GRASP, PLACE)


def test_the_pipe_is_carried_to_the_place_and_seen_there_and_nothing_is_held_afterwards(session, machine):
    _click_all(session)
    assert session.state()["stage"] == "confirm" and session.state()["steps"] == list(PLACE_STEPS)
    session.confirm()
    heights = []
    _until(lambda: heights.append(machine.state().pipe.lowest()) or session.state()["stage"] == "live")
    state = session.state()
    assert state["mode"] == "done" and state["message"].startswith("Done after"), state["error"]
    assert max(heights) == pytest.approx(TABLE.top[2] + 0.10, abs=0.03)  # it was lifted
    pipe = machine.state().pipe
    np.testing.assert_allclose(pipe.point[:2], PLACE[:2], atol=0.03)
    assert pipe.lowest() == pytest.approx(TABLE.top[2], abs=1e-6) and pipe.axis[2] > 0.999
    np.testing.assert_allclose(machine.state().position, home_posture(), atol=np.radians(1.0))
    assert not state["can_release"]
    session.snapshot()
    session.click(*pixel(pipe.point))  # the camera sees it there
    assert session.state()["stage"] == "grasp"
    session.back()
    with pytest.raises(InputError, match=r"not on an object|nothing within reach"):
        session.click(*pixel(PIPE.point))  # and no longer here


@pytest.mark.parametrize("machine", [5.0], indirect=True)  # slow enough to be caught on the way
@pytest.mark.thorough
def test_stopped_with_the_pipe_in_hand_it_may_be_aborted_and_released(session, machine):
    _click_all(session)
    session.confirm()
    _until(lambda: session.state()["step"] == "carry")
    session.order(Order.ABORT)
    _until(lambda: session.state()["stage"] == "live")
    assert machine.state().pipe.lowest() > TABLE.top[2] + 0.03 and session.state()["can_release"]
    session.release()
    _until(lambda: session.state()["stage"] == "live")
    assert session.state()["mode"] == "done", session.state()["error"]
    np.testing.assert_allclose(machine.state().position, home_posture(), atol=np.radians(1.0))
    assert machine.state().pipe.lowest() == pytest.approx(TABLE.top[2], abs=1e-6)  # it fell on the table


def test_wrong_clicks_are_refused_and_the_stage_stays(session):
    session.snapshot()
    _click(session, RAISED, GRASP)
    for point, message in [(PIPE.point, "on the pipe itself"), ([2.6, 0.5, 1.2], "nothing within reach")]:
        with pytest.raises(InputError, match=message):
            _click(session, point)
        assert session.state()["stage"] == "place"
    with pytest.raises(InputError, match="object, grasp and place must be clicked"):
        session.confirm()


def test_changing_the_task_keeps_object_and_grasp_and_forgets_the_last_point(session):
    _click_all(session)
    session.set_task("cut")
    assert session.state()["stage"] == "cut" and session.state()["steps"] == list(STEPS)
    _click(session, PIPE.point)
    assert session.state()["stage"] == "confirm"
    session.set_task("place")
    assert session.state()["stage"] == "place"
    for stage in ("grasp", "object", "live"):
        session.back()
        assert session.state()["stage"] == stage
    with pytest.raises(InputError, match="choose from cut, place"):
        session.set_task("weld")


def test_a_clamped_pipe_that_leaves_the_picture_is_not_carried_and_nothing_moves():
    machine = Machine(home_posture(), realtime_rate=25.0)
    session = OperatorSession(
        lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1), table=TABLE), machine, seed=1
    )
    session.set_task("place")
    _click_all(session)
    session.confirm()
    _until(lambda: session.state()["stage"] == "confirm")
    assert "leaves the picture" in session.state()["error"]
    np.testing.assert_array_equal(machine.state().position, home_posture())
    session.close()
    machine.close()
