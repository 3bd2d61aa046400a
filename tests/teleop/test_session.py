"""The operator's work without a browser: clicks, corrections, refusals, the whole task, release."""

import threading
import time

import cv2
import numpy as np
import pytest
from casting import cast_crossing

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop import camera_thread
from hydrolek_drake.teleop.machine import Machine
from hydrolek_drake.teleop.sequencer import Order
from hydrolek_drake.teleop.session import OperatorSession
from hydrolek_drake.vision.camera import recorded_camera
from hydrolek_drake.vision.frames import Frame, FrameSource
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture
from hydrolek_drake.workcell.simulated_kinect import SimulatedKinect, as_machine_stands

COLUMN = 319.5  # the default pipe stands in the middle of the picture


@pytest.fixture
def machine():
    machine = Machine(home_posture(), realtime_rate=25.0)
    yield machine
    machine.close()


@pytest.fixture
def session(machine):
    session = OperatorSession(
        lambda: SimulatedKinect(make_pipe(), np.random.default_rng(1)),
        machine,
        seed=1,
        stand=as_machine_stands,
    )
    yield session
    session.close()


def _until(condition, seconds=30.0):
    limit = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < limit, f"did not happen within {seconds} s"
        time.sleep(0.02)


def _click_all(session):
    session.snapshot()
    for v in (150, 180, 110):
        session.click(COLUMN, v)


def test_four_clicks_and_a_confirmation_do_the_task_and_a_release_brings_both_arms_home(session, machine):
    _click_all(session)
    assert session.state()["stage"] == "confirm"
    np.testing.assert_array_equal(machine.state().position, home_posture())  # nothing moves before
    session.confirm()
    _until(lambda: session.state()["stage"] == "live")
    assert session.state()["mode"] == "done" and session.state()["message"].startswith("Done after")
    assert session.state()["can_release"]
    session.release()
    _until(lambda: session.state()["stage"] == "live")
    assert session.state()["mode"] == "done", session.state()["error"]
    np.testing.assert_allclose(machine.state().position, home_posture(), atol=np.radians(1.0))
    assert not session.state()["can_release"]


def test_each_click_changes_the_pictures_and_back_takes_it_back(session):
    session.refresh()
    stages, pictures = [], []
    session.snapshot()
    for v in (150, 180, 110):
        session.click(COLUMN, v)
        stages.append(session.state()["stage"])
        pictures.append(session.picture("colour"))
    assert stages == ["grasp", "cut", "confirm"] and len(set(pictures)) == 3
    assert cv2.imdecode(np.frombuffer(session.picture("edges"), np.uint8), 1).shape == (480, 640, 3)
    for stage in ("cut", "grasp", "object", "live"):
        session.back()
        assert session.state()["stage"] == stage
    assert session.picture("edges") == b""


def test_sliders_change_the_edge_picture_at_once(session):
    session.snapshot()
    before = session.picture("edges")
    session.set_sliders(sensitivity=0.9)
    assert session.picture("edges") != before
    with pytest.raises(InputError, match="between 0 and 1"):
        session.set_sliders(sensitivity=7.0)
    assert session.state()["sliders"]["sensitivity"] == 0.9
    with pytest.raises(InputError, match="choose from"):
        session.set_sliders(brightness=0.5)


@pytest.mark.parametrize(
    ("click", "message"),
    [((-10, 10), "outside the picture"), ((500, 50), "nothing within reach"), ((float("nan"), 0), "finite")],
)
def test_a_wrong_click_is_refused_and_the_arms_stand_still(session, machine, click, message):
    session.snapshot()
    with pytest.raises(InputError, match=message):
        session.click(*click)
    assert session.state()["stage"] == "object"
    np.testing.assert_array_equal(machine.state().position, home_posture())


def test_what_is_too_early_is_refused(session):
    with pytest.raises(InputError, match="take a snapshot"):
        session.click(COLUMN, 100)
    with pytest.raises(InputError, match="must be clicked"):
        session.confirm()
    with pytest.raises(InputError, match="nothing is held"):
        session.release()


def test_a_pipe_out_of_reach_is_told_and_nothing_moves(machine):
    session = OperatorSession(
        lambda: SimulatedKinect(make_pipe([2.1, 0.0, 1.06]), np.random.default_rng(1)), machine, seed=1
    )
    _click_all(session)
    session.confirm()
    _until(lambda: session.state()["stage"] == "confirm")
    assert "the right arm cannot grasp there" in session.state()["error"]
    np.testing.assert_array_equal(machine.state().position, home_posture())
    session.close()


def test_an_unforeseen_failure_of_the_planner_is_shown(session, machine, monkeypatch):
    def fails(*_arguments, **_named):
        raise ZeroDivisionError("planted")

    monkeypatch.setattr("hydrolek_drake.teleop.task_planner.plan_task", fails)
    _click_all(session)
    session.confirm()
    _until(lambda: session.state()["stage"] == "live")
    assert "planted" in session.state()["error"] and session.state()["mode"] == "idle"


def test_a_stop_while_planning_keeps_the_arms_from_starting(session, machine):
    _click_all(session)
    session.confirm()
    session.order(Order.STOP)
    assert session.state()["stage"] == "confirm"
    time.sleep(4.0)  # longer than the planning takes
    assert session.state()["mode"] == "idle"
    np.testing.assert_array_equal(machine.state().position, home_posture())


class _Broken(FrameSource):
    """Gives one frame without any depth, then none."""

    def __init__(self):
        self.frames = [
            Frame(np.zeros((480, 640, 3), np.uint8), np.zeros((480, 640), np.uint16), recorded_camera(), "x")
        ]

    def read(self):
        if not self.frames:
            raise InputError("camera 0 gives no more frames; check its cable and power")
        return self.frames.pop()


def test_depth_of_holes_and_a_lost_camera_are_told(machine):
    session = OperatorSession(_Broken, machine, seed=1)
    session.snapshot()
    with pytest.raises(InputError, match="nothing within reach"):
        session.click(COLUMN, 100)
    session.refresh()
    assert "cable" in session.state()["error"]
    with pytest.raises(InputError, match="cable"):
        session.snapshot()
    session.close()


class _Losable(FrameSource):
    """Gives frames of a table, until it is lost or mute."""

    def __init__(self):
        self.reason, self.may_answer = "", threading.Event()
        self.may_answer.set()

    def read(self):
        self.may_answer.wait()
        if self.reason:
            raise InputError(self.reason)
        empty = np.zeros((480, 640, 3), np.uint8)
        return Frame(empty, np.full((480, 640), 1200, np.uint16), recorded_camera(), "losable")


def _moving_by_hand(session):
    session.move_by_hand(deflection=[30.0, *[0.0] * 13])
    return session.state()["valves_open"]


def test_a_lost_camera_stops_what_moves_once_and_is_told_until_it_is_back(machine):
    camera = _Losable()
    session = OperatorSession(lambda: camera, machine, seed=1)
    session.refresh()
    assert _moving_by_hand(session)
    camera.reason = "the camera gives no more frames; check its cable and power"
    session.refresh()
    assert not session.state()["valves_open"]
    assert "cable" in session.state()["error"] and "arms are stopped" in session.state()["error"]
    assert not _moving_by_hand(session)  # the hand must have let go first
    session.let_go()
    session.refresh()  # still lost: who moves them now does so without a picture
    assert _moving_by_hand(session)
    camera.reason = ""
    session.refresh()
    assert session.state()["error"] == ""
    session.close()


def test_a_camera_lost_on_the_way_stops_the_task_which_may_be_resumed(machine):
    lost = threading.Event()

    class Kinect(SimulatedKinect):
        def read(self):
            if lost.is_set():
                raise InputError("camera 0 gives no more frames; check its cable and power")
            return super().read()

    session = OperatorSession(
        lambda: Kinect(make_pipe(), np.random.default_rng(1)), machine, seed=1, stand=as_machine_stands
    )
    _click_all(session)
    session.confirm()
    _until(lambda: session.state()["mode"] == "running")
    lost.set()
    session.refresh()
    _until(lambda: session.state()["mode"] == "stopped")
    where = machine.state().position.copy()
    time.sleep(0.2)
    np.testing.assert_allclose(machine.state().position, where, atol=np.radians(1.0))
    assert "cable" in session.state()["error"] and session.state()["stage"] == "moving"
    lost.clear()
    session.refresh()
    assert session.state()["error"] == ""
    session.order(Order.RESUME)
    _until(lambda: session.state()["stage"] == "live")
    assert session.state()["mode"] == "done"
    session.close()


def test_a_mute_camera_counts_as_lost_and_does_not_hold_the_session(machine, monkeypatch):
    monkeypatch.setattr(camera_thread, "teleop_entries", lambda part: {"mute": 0.2})
    camera = _Losable()
    session = OperatorSession(lambda: camera, machine, seed=1)
    session.refresh()
    assert _moving_by_hand(session)
    camera.may_answer.clear()
    session.refresh()
    assert not session.state()["valves_open"] and "has not answered for 0.2 s" in session.state()["error"]
    with pytest.raises(InputError, match="has not answered"):
        session.snapshot()
    camera.may_answer.set()
    _until(lambda: session.refresh() or session.state()["error"] == "")
    session.snapshot()
    session.close()


def test_an_unsure_object_is_shown_as_such_until_the_grasp(machine):
    colour, depth, _, _ = cast_crossing(0.01)
    frame = Frame(colour, depth, recorded_camera(), "cast")

    class Crossing(FrameSource):
        def read(self):
            return frame

    session = OperatorSession(Crossing, machine, seed=1)
    session.snapshot()
    session.click(100, 240)
    first = session.picture("colour")
    assert session.state()["unsure"] and "Unsure of this outline" in session.state()["message"]
    session.click(100, 240)
    assert session.state()["stage"] == "grasp" and session.state()["unsure"]
    assert session.picture("colour") != first
    session.click(160, 240)
    assert session.state()["stage"] == "cut" and not session.state()["unsure"]
    assert session.state()["message"] == ""
    session.back()
    assert session.state()["unsure"] and session.state()["message"] != ""
    session.close()


@pytest.mark.parametrize("failure", [OSError("unplugged"), ValueError("odd frame")])
def test_a_camera_that_fails_in_any_way_stops_what_moves(machine, failure):
    class Failing(_Losable):
        broken = False

        def read(self):
            if self.broken:
                raise failure
            return super().read()

    camera = Failing()
    session = OperatorSession(lambda: camera, machine, seed=1)
    session.refresh()
    assert _moving_by_hand(session)
    camera.broken = True
    session.refresh()
    assert not session.state()["valves_open"] and str(failure) in session.state()["error"]
    session.close()


def test_a_planning_that_was_withdrawn_and_fails_later_changes_nothing(session, machine):
    go_on = threading.Event()
    failed = []

    def fails():
        go_on.wait(5.0)
        raise RuntimeError("unforeseen")

    undertaking = session._undertaking
    undertaking.begin(fails, started=lambda plan: None, failed=failed.append)
    undertaking.withdraw()
    go_on.set()
    undertaking._planner.submit(lambda: None).result()
    time.sleep(0.1)
    assert failed == []
