"""The sequencer on a bare Context: order of steps, tolerances, stop, resume, abort, time-out."""

import numpy as np
import pytest
from pydrake.systems.analysis import Simulator

from hydrolek_drake.errors import InputError
from hydrolek_drake.teleop.configuration import teleop_entries
from hydrolek_drake.teleop.hand import travel
from hydrolek_drake.teleop.link.messages import decode, encode
from hydrolek_drake.teleop.plan import STEPS
from hydrolek_drake.teleop.sequencer import Mode, Order, TaskSequencer
from hydrolek_drake.workcell.scene import home_posture

PERIOD = teleop_entries("task")["period"]


class Rig:
    """Sequencer with arms that are where they should be, less `lag` in rad, unless they are jammed."""

    def __init__(self, plan):
        self.system = TaskSequencer()
        self.simulator = Simulator(self.system)
        self.context = self.simulator.get_mutable_context()
        self.position, self.jammed, self.lag = home_posture(), False, 0.0
        self.order = Order.NONE
        self.advance()
        self.system.start(self.context, plan, self.position)

    def advance(self, count=1):
        for _ in range(count):
            self.system.position_measured_input.FixValue(self.context, self.position)
            self.system.order_input.FixValue(self.context, [float(self.order)])
            self.simulator.AdvanceTo(self.system.one_update_on(self.context))
            if not self.jammed and self.open():
                self.position = self.desired() - self.lag

    def desired(self):
        return np.array(self.system.position_desired_output.Eval(self.context))

    def open(self):
        return self.system.valves_open_output.Eval(self.context)[0] == 1.0

    def mode(self):
        return self.system.mode(self.context)


def test_ports_and_feedthrough():
    system = TaskSequencer()
    assert not system.HasAnyDirectFeedthrough()
    assert [system.get_input_port(i).get_name() for i in range(2)] == ["position_measured", "order"]
    assert system.position_desired_output.size() == 14 and system.progress_output.size() == 4


def test_one_update_at_a_time_whatever_rounding_does(plan):
    rig, path = Rig(plan), plan.steps[0].trajectory
    for k in range(1, int(path.end_time() / PERIOD)):
        rig.advance()
        np.testing.assert_allclose(rig.desired(), path.value(k * PERIOD)[:, 0], atol=1e-12)


def test_idle_holds_the_measured_position_with_closed_valves():
    system = TaskSequencer()
    simulator = Simulator(system)
    context = simulator.get_mutable_context()
    system.position_measured_input.FixValue(context, home_posture() + 0.1)
    system.order_input.FixValue(context, [0.0])
    simulator.AdvanceTo(2 * PERIOD)
    np.testing.assert_allclose(system.position_desired_output.Eval(context), home_posture() + 0.1)
    assert system.valves_open_output.Eval(context)[0] == 0.0


def test_all_steps_run_in_order_in_the_planned_time_and_the_settling(plan):
    rig, seen, seconds = Rig(plan), [], 0.0
    while rig.mode() is Mode.RUNNING:
        name = rig.system.step_name(rig.context)
        if not seen or seen[-1] != name:
            seen.append(name)
        rig.advance()
        seconds += PERIOD
        assert seconds < 200
    assert rig.mode() is Mode.DONE and tuple(seen) == STEPS
    settling = len(STEPS) * teleop_entries("task")["settled"]
    assert seconds == pytest.approx(plan.duration() + settling, abs=len(STEPS) * 3 * PERIOD)
    last = plan.steps[-1].trajectory
    np.testing.assert_allclose(rig.desired(), last.value(last.end_time())[:, 0], atol=1e-9)


def test_a_step_waits_until_the_joints_are_within_the_tolerance(plan):
    rig = Rig(plan)
    rig.lag = np.radians(teleop_entries("task")["tolerance_deg"]) * 1.2
    rig.advance(int((plan.steps[0].trajectory.end_time() + 3.0) / PERIOD))
    assert rig.system.step_name(rig.context) == STEPS[0]
    rig.lag = np.radians(teleop_entries("task")["tolerance_deg"]) * 0.8
    rig.advance(int(1.0 / PERIOD))
    assert rig.system.step_name(rig.context) == STEPS[1]


def test_an_arm_that_its_gripper_has_drawn_to_the_pipe_is_not_pressed_back(plan):
    """Set points of the gripping arm, and of no other joint, follow it once the gripper has closed."""
    rig, beyond = Rig(plan), 1.6 * np.radians(teleop_entries("task")["tolerance_deg"])
    while rig.system.step_name(rig.context) != "close":
        rig.advance()
    rig.lag = np.zeros(14)
    rig.lag[[0, 6, 7]] = [-beyond, -np.radians(20.0), 0.0]  # drawn, and the jaw closed on the pipe
    while rig.system.step_name(rig.context) == "close":
        rig.advance()
    assert rig.system.step_name(rig.context) == "cut start"
    closed = plan.steps[2].trajectory.value(plan.steps[2].trajectory.end_time())[:, 0]
    rig.lag = np.zeros(14)
    rig.advance()
    moved = rig.desired() - closed
    assert moved[0] == pytest.approx(beyond, abs=1e-9)
    assert not moved[1:7].any()
    while rig.mode() is Mode.RUNNING:
        rig.advance()
    assert rig.mode() is Mode.DONE
    assert rig.desired()[0] - closed[0] == pytest.approx(beyond, abs=1e-9)


def test_what_is_held_lies_within_the_travel_whatever_the_sensors_noise(plan):
    rig, (lower, upper) = Rig(plan), travel()
    rig.advance(5)
    rig.jammed = True
    rig.position[[6, 13]] = [lower[6] - 1e-3, upper[13] + 1e-3]
    rig.order = Order.STOP
    rig.advance()
    assert rig.desired()[6] == lower[6] and rig.desired()[13] == upper[13]
    decode(encode(rig.desired()))  # the link takes it


def test_stop_holds_at_once_with_closed_valves_and_resume_goes_on_from_there(plan):
    rig = Rig(plan)
    rig.advance(20)
    rig.order = Order.STOP
    rig.advance()
    where = rig.position.copy()
    assert rig.mode() is Mode.STOPPED and not rig.open()
    rig.advance(200)
    np.testing.assert_allclose(rig.desired(), where, atol=1e-12)
    assert rig.mode() is Mode.STOPPED
    rig.order = Order.RESUME
    rig.advance()
    assert rig.mode() is Mode.RUNNING and rig.open()
    limit = np.radians(30) * PERIOD * 3
    assert np.max(np.abs(rig.desired() - where)) < limit  # no jump
    while rig.mode() is Mode.RUNNING:
        rig.advance()
    assert rig.mode() is Mode.DONE


def test_abort_holds_and_cannot_be_resumed_but_another_task_may_start(plan):
    rig = Rig(plan)
    rig.advance(5)
    rig.order = Order.ABORT
    rig.advance()
    assert rig.mode() is Mode.ABORTED and not rig.open()
    rig.order = Order.RESUME
    rig.advance(3)
    assert rig.mode() is Mode.ABORTED
    rig.position = home_posture()
    rig.system.start(rig.context, plan, rig.position)
    assert rig.mode() is Mode.RUNNING


def test_jammed_arms_time_out_and_may_be_resumed(plan):
    rig = Rig(plan)
    rig.jammed = True
    rig.advance(int(plan.steps[0].timed_out_after / PERIOD) + 2)
    assert rig.mode() is Mode.TIMED_OUT and not rig.open()
    rig.jammed, rig.order = False, Order.RESUME
    rig.advance(int(2.0 / PERIOD))
    assert rig.mode() is Mode.RUNNING


def test_a_task_does_not_start_twice_or_from_elsewhere(plan):
    rig = Rig(plan)
    with pytest.raises(InputError, match="a task is running"):
        rig.system.start(rig.context, plan, home_posture())
    fresh = TaskSequencer()
    with pytest.raises(InputError, match=r"moved by 17\.2 deg"):
        fresh.start(fresh.CreateDefaultContext(), plan, home_posture() + 0.3)
