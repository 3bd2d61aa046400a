"""Components that make no sense are refused in one line, and what is sound has scales and can be checked."""

import math

import numpy as np
import pytest

from hydrolek_drake.checking.rig_checks import check_rig
from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.linkage import stroke_and_lever
from hydrolek_drake.rollout.one_point import drive_force, driven_inertia, full_flow


@pytest.mark.parametrize(
    ("name", "wrong", "says"),
    [
        (
            "four_bar",
            {"linkage.link_angle": -0.349, "linkage.coupler": 0.4},
            "mechanism, at 20.0 deg",
        ),
        ("four_bar", {"linkage.assembly": 0.5}, "0.5 is not a direction"),
        ("lever_table", {"linkage.last_position": 0.5}, "upper_stop is at 1.14"),
        ("flow_map", {"valve.flow_a_60_high": 1e-9}, "fall with the pressure drop"),
        ("flow_map", {"valve.drop_middle": 4e5}, "must rise"),
        ("pulse_width", {"amplifier.least_duty": 0.9}, "must lie below most_duty"),
        ("counterbalance", {"holding.at_a": 0.5}, "must be 0 or 1"),
        ("counterbalance", {"holding.at_a": 0.0}, "one of them 1"),
    ],
)
def test_numbers_that_make_no_sense_are_refused(with_component, name, wrong, says):
    with pytest.raises(InputError, match=says):
        with_component(name).with_values(wrong)


@pytest.mark.parametrize(
    ("name", "says"),
    [("held_pump", "no valve's edges|valve's edges to stand in series"), ("electric_hose", "has no oil")],
)
def test_what_would_act_on_nothing_is_refused(with_component, name, says):
    with pytest.raises(InputError, match=says):
        with_component(name)


def test_a_mechanism_pressed_beyond_its_reach_stays_finite(with_component):
    joint = with_component("four_bar").records()[0]
    for q in np.radians(np.linspace(-180.0, 180.0, 721)):
        assert all(map(math.isfinite, stroke_and_lever(float(q), joint)))


def test_a_pump_in_a_valve_s_place_and_a_ball_screw_have_their_scales(with_component):
    pump = with_component("pump_controlled").records()[0]
    assert full_flow(16e6, 8e6, pump) == pytest.approx(6 / 6e4)
    screw = with_component("ball_screw").records()[0]
    assert drive_force(10.0, screw) == pytest.approx(2 * math.pi / 5e-3 * 0.9 * 0.08 * 4.0)
    assert driven_inertia(screw) == pytest.approx(95.1089 + 2e-5 * (2 * math.pi / 5e-3) ** 2)


@pytest.mark.parametrize("name", ["pump_controlled", "accumulator", "hose", "lever_table", "four_bar"])
def test_a_machine_with_a_component_is_checked_without_a_complaint_of_it(with_component, name):
    assert not [each for each in check_rig(with_component(name)) if "longest_step" not in each.about]


def test_a_mechanism_whose_piston_would_leave_its_cylinder_is_complained_of(with_component):
    rig = with_component("four_bar").with_values({"linkage.zero_stroke_length": 0.6})
    assert any("behind the piston's end" in each.says for each in check_rig(rig))
