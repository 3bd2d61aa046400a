"""Answers that data sheets of other people's machines ask for: compensated valves, unipolar commands, short travels."""

import numpy as np
import pytest
from sheets import LINK, SLIDE

from hydrolek_drake.errors import InputError
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.wizard import read_answers
from hydrolek_drake.wizard.making import written_rig
from hydrolek_drake.wizard.sheet import Sheet

COMPENSATED = SLIDE | {"compensated": "yes", "rated_flow": "6 6 8 8 l/min", "full_command": "3 V"}
LONG = LINK | {"stroke": "0.5 m", "link_travel": "-40, 60 deg"}
"""A cylinder that could not be drawn in: the link's own stops end its motion before."""


def _end_speed(rig, volts: float) -> float:
    """Speed under a constant command, away from the stops [m/s]."""
    times = np.arange(0.0, 0.6, 0.01)
    command = np.where(times < 0.1, rig.value("command.neutral"), volts)
    done = roll_out(rig.records(), times, command, times, longest_step=2e-4)
    assert not done.diverged
    return float(np.median(done.signals.velocity[-10:]))


def test_a_compensated_valve_gives_the_rated_flow_whatever_pushes():
    rig = written_rig("axis", COMPENSATED)[1]
    assert rig.variant("joint", "valve") == "pressure_compensated"
    area = rig.value("cylinder.area_a")
    for offset in (0.0, 600.0):
        loaded = rig.with_values({"effects.load.offset_force.force_N": offset})
        assert _end_speed(loaded, 3.0) == pytest.approx(6e-3 / 60 / area, rel=0.02)


def test_damping_is_assumed_by_the_speed_that_compensators_allow():
    flows = Sheet(read_answers(COMPENSATED)), Sheet(read_answers(COMPENSATED | {"compensated": "no"}))
    assert flows[0].speed == pytest.approx(6e-3 / 60 / flows[0].area_a)
    assert flows[1].speed > 2.0 * flows[0].speed


def test_commands_count_from_neutral_and_may_retract_above_it():
    rig = written_rig("axis", COMPENSATED | {"neutral_command": "6 V", "extends_at": "below"})[1]
    assert _end_speed(rig, 3.0) > 0.0 > _end_speed(rig, 9.0)
    assert _end_speed(rig, 6.0) == pytest.approx(0.0, abs=1e-4)


def test_what_flows_back_through_a_compensated_valve_is_told_by_its_drop():
    rig = written_rig("axis", COMPENSATED)[1]
    assert rig.value("valve.return_coefficient") == pytest.approx(8e-3 / 60 / np.sqrt(5e5), rel=1e-3)


def test_a_link_s_own_stops_end_its_motion_where_the_cylinder_s_do_not():
    rig = written_rig("link", LONG)[1]
    assert np.degrees(rig.value("load.lower_stop")) == pytest.approx(-40.0)
    assert np.degrees(rig.value("load.upper_stop")) == pytest.approx(60.0)
    times = np.arange(0.0, 3.0, 0.01)
    for volts, stop in ((10.0, 60.0), (-10.0, -40.0)):
        held = np.full(times.size, volts)
        ended = np.degrees(
            roll_out(rig.records(), times, held, times, longest_step=2e-4).signals.position[-1]
        )
        assert ended == pytest.approx(stop, abs=3.0)


@pytest.mark.parametrize(
    ("sheet", "says"),
    [
        (LINK | {"stroke": "0.5 m"}, "--link-travel"),
        (LONG | {"link_travel": "-40, 150 deg"}, "no lever left"),
        (LONG | {"link_travel": "20, 60 deg"}, "must hold --mid-stroke-at"),
        (LONG | {"stroke": "0.9 m"}, "no length drawn in"),
        (COMPENSATED | {"overlap": "-0.05 mm"}, "an underlap"),
        (LONG | {"link_travel": "20 deg"}, "1 numbers, where 2 belong"),
        (LINK | {"compensated": "yes"}, "told by --rated-flow"),
        (COMPENSATED | {"rated_flow": "24 20 30 30"}, "alike towards A and B"),
        (COMPENSATED | {"holding": "pilot_check"}, "leave it or --compensated out"),
        (SLIDE | {"extends_at": "up"}, "choose above or below"),
    ],
)
def test_what_contradicts_itself_is_refused_in_one_line(sheet, says):
    with pytest.raises(InputError) as caught:
        written_rig("axis", sheet)
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_a_speed_loop_without_integral_has_none():
    sheet = {
        "moves": "screw", "travel": "250 mm", "lead": "20 mm", "torque_constant": "0.1 N m/A", "peak_current": "10 A",
        "mass": "95 kg", "position_gain": "160 1/s", "speed_bandwidth": "14 Hz",
    }  # fmt: skip
    entry = written_rig("axis", sheet | {"speed_time": "0"})[1].entries["joints.joint.cylinder.speed_time"]
    assert entry.value == 0.0 and entry.range is None
    assumed = written_rig("axis", sheet)[1].entries["joints.joint.cylinder.speed_time"]
    assert assumed.value > 0.0 and assumed.range is not None
