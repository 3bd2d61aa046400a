"""Split-range control of the gripper's force (thesis 3.2): the law, and the force on the full plant."""

import numpy as np
import pytest

from hydrolek_drake.control.laws.grip_force import GripForceLaw, Range
from hydrolek_drake.control.laws.scaled_input import ScaledInput
from hydrolek_drake.control.thesis_gains import sample_s
from hydrolek_drake.kinematics.forward import tool_pose
from hydrolek_drake.kinematics.frames import in_frame
from hydrolek_drake.teleop.controllers.hydraulic_arms import HydraulicArms
from hydrolek_drake.workcell.pipe import make_pipe
from hydrolek_drake.workcell.scene import home_posture

SECOND = round(1.0 / sample_s())
JAW, OPEN_DEG = 6, 24.0  # of the right arm; some degrees off a pipe of 75 mm, whose contact begins at 23 deg
SETTLED = 0.05  # of the set point, the usual band


def _law(**changes):
    values = {
        "approach": Range(0.1, 0.0, 0.0, 30.0),
        "hold": Range(0.02, 0.05, 0.2, 20.0),
        "threshold_N": 40.0,
        "tolerance_N": 10.0,
        "closing": -1.0,
        "sample_s": 0.05,
        "element": ScaledInput(-1.2, 1.3, -2.0, 3.0, 0.008, 0.017, 100.0),
    }
    return GripForceLaw(**(values | changes))


def test_one_output_drives_both_directions_of_the_valve_past_their_dead_zones():
    law = _law()
    at_rest = law.initial(500.0)
    _, closing, volts = law.step(at_rest, 600.0, 500.0)
    assert closing > 0.0 and volts < -1.2
    _, opening, volts = law.step(at_rest, 400.0, 500.0)
    assert opening < 0.0 and volts > 1.3
    _, output, volts = law.step(at_rest, 505.0, 500.0)
    assert output == volts == 0.0


def test_gains_are_high_below_the_threshold_and_low_beyond_it():
    law = _law(hold=Range(0.02, 0.0, 0.0, 20.0))
    outputs = [law.step(law.initial(force), force + 100.0, force)[1] for force in (39.0, 41.0)]
    assert outputs == pytest.approx([10.0, 2.0])
    assert law.step(law.initial(0.0), 5000.0, 0.0)[1] == 30.0
    assert law.step(law.initial(100.0), 5000.0, 100.0)[1] == 20.0


def test_a_force_that_grows_fast_enough_shuts_the_valve_ahead_of_the_set_point():
    law = _law(hold=Range(0.02, 0.0, 0.2, 20.0))
    _, output, volts = law.step(law.initial(400.0), 500.0, 420.0)  # 400 N/s for 0.2 s are 80 N
    assert output == volts == 0.0


def test_the_integral_crosses_the_dead_zone_and_does_not_wind_up():
    law, state = _law(), _law().initial(450.0)
    outputs = []
    for _ in range(4 * SECOND):
        state, output, _ = law.step(state, 500.0, 450.0)
        outputs.append(output)
    assert outputs[0] < 2.0 < 10.0 < outputs[-1] and (np.diff(outputs) > 0.0).all()
    for _ in range(100 * SECOND):
        state, output, _ = law.step(state, 500.0, 450.0)
    assert output <= 20.0 and state[0] <= 20.0
    _, output, _ = law.step(
        state, 500.0, 20.0
    )  # contact is lost: the integral of the other range is none of this one
    assert output == 30.0


@pytest.mark.parametrize(("wanted", "force"), [(np.nan, 100.0), (500.0, np.nan), (np.inf, 0.0)])
def test_what_is_no_force_closes_the_valve(wanted, force):
    state, output, volts = _law().step(np.array([5.0, 1.0, 80.0]), wanted, force)
    assert output == volts == 0.0 and state[0] == 0.0 and np.isfinite(state).all()


def _arms_with_a_pipe_in_the_right_gripper():
    posture = home_posture()
    posture[JAW] = np.radians(OPEN_DEG)
    pose = tool_pose(posture[:6])
    point, tip = (
        in_frame(place, given_in="right_base", wanted_in="world")
        for place in (pose[:3, 3], pose[:3, 3] + pose[:3, 2])
    )
    return HydraulicArms(posture, pipe=make_pipe(point, tip - point))


@pytest.mark.long("8 s: the full plant")
def test_the_force_settles_at_the_set_point_up_and_down_and_the_oil_holds_it():
    arms = _arms_with_a_pipe_in_the_right_gripper()
    peak = 0.0
    for wanted in (500.0, 200.0):
        for _ in range(6 * SECOND):
            arms.advance(grip=[wanted, np.nan])
            peak = max(peak, float(arms.grip()[0]))
        assert arms.grip()[0] == pytest.approx(wanted, rel=SETTLED)
    assert peak < 500.0 * (1.0 + 2.0 * SETTLED)
    assert arms.grip()[1] == 0.0
    held = arms.grip()[0]
    for _ in range(2 * SECOND):  # the set point is withdrawn: the valve closes, the trapped oil holds
        arms.advance(grip=[np.nan, np.nan])
        assert arms.signals().voltage[JAW] == 0.0
    assert arms.grip()[0] == pytest.approx(held, rel=SETTLED)
