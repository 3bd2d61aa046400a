"""A drive that follows a commanded position, beside the linear equations that it is away from its limits."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.inverse_dynamics.regression import motor_joint
from hydrolek_drake.replay.by_diagram import moved_by_diagram
from hydrolek_drake.replay.driving import Driven
from hydrolek_drake.rollout import roll_out

STEP = 2.5e-4
PER_AMP = 2 * math.pi / 5e-3 * 0.9 * 0.3
MASS = 95.1089 + 2e-4 * (2 * math.pi / 5e-3) ** 2


def _rolled(rig, volts, times, **options):
    return roll_out(rig.records(), times, volts, times, longest_step=STEP, **options).signals


def _exact(p, set_point, times, load=0.0, damping=203.5034):
    """Position and current for a held set point, from rest at zero: the cascade and the mass as one linear system."""
    per_speed, k = p["speed_gain"], p["position_gain"]
    integral = k / p["position_time"] if p["position_time"] else 0.0
    deficit = 1.0 / p["speed_time"] if p["speed_time"] else 0.0
    speed = np.array([-k, 0.0, integral, 0.0, k * set_point])  # of q, w, lag, deficit, 1
    slow = speed - [0, 1, 0, 0, 0]
    current = per_speed * (slow + np.array([0, 0, 0, deficit, 0]))
    a = np.zeros((5, 5))
    a[0, 1] = 1.0
    a[1] = (PER_AMP * current - [0, damping, 0, 0, load]) / MASS
    a[2] = [-1.0, 0, 0, 0, set_point]
    a[3] = slow
    start = np.array([0.0, 0.0, 0.0, load / PER_AMP / per_speed / deficit if deficit else 0.0, 1.0])
    state = np.array([expm(a * t) @ start for t in times])
    return state[:, 0], state @ current


@pytest.mark.parametrize("position_time", [0.0, 0.5])
@pytest.mark.parametrize("speed_time", [0.0, 0.04])
def test_away_from_its_limits_it_is_the_linear_cascade(with_component, position_time, speed_time):
    loops = {
        "position_gain": 12.0,
        "position_time": position_time,
        "speed_gain": 60.0,
        "speed_time": speed_time,
    }
    rig = with_component("servo_screw").with_values(
        {f"cylinder.{name}": value for name, value in loops.items()}
        | {"load.gravity_cos": 80.0 * bool(speed_time)}
    )
    times = np.arange(0.0, 1.0, 0.01)
    signals = _rolled(rig, np.full(times.size, 0.5), times)  # 5 mm
    position, current = _exact(loops, 5e-3, times, load=80.0 * bool(speed_time))
    assert np.abs(current).max() < 8.0  # or a limit would act
    assert_allclose(signals.position, position, atol=2e-7)
    moved = slice(1, None)  # the first command arrives after the first row is written
    assert_allclose(signals.current[moved], 0.4 + np.abs(current[moved]), atol=1e-4)


def test_a_ramp_is_followed_with_the_lag_of_speed_over_gain_or_with_none(with_component):
    """Beckhoff, TC3 axis commissioning: following error is speed over K_v; an integral takes it away."""
    times = np.arange(0.0, 4.0, 1e-3)
    ramp = 24e-3 * (times + 5e-4)  # what is held over a sample is the ramp's mean there
    for position_time, lag in ((0.0, 24e-3 / 12.0), (0.3, 0.0)):
        rig = with_component("servo_screw").with_values(
            {"cylinder.position_time": position_time, "load.damping": 5000.0}
        )
        signals = _rolled(rig, ramp / 10e-3, times)
        assert 24e-3 * times[-1] - signals.position[-1] == pytest.approx(lag, abs=2e-6)
        stairs = 60.0 * 12.0 * 12e-6  # of a millisecond: half of one, times both gains
        assert signals.current[-1] == pytest.approx(0.4 + 5000.0 * 24e-3 / PER_AMP, abs=1.01 * stairs)


def test_friction_shows_in_the_current_and_not_in_the_position(with_component):
    rig = with_component("servo_screw")
    times = np.arange(0.0, 3.0, 1e-3)
    volts = np.clip(2.4 * times, 0.0, 5.0)
    plain, rubbing = (
        _rolled(rig.with_values({"effects.load.coulomb_friction.force_N": force}), volts, times)
        for force in (0.0, 200.0)
    )
    moving = (times > 1.0) & (times < 2.0)
    assert_allclose((rubbing.current - plain.current)[moving], 200.0 / PER_AMP, rtol=0.02)
    assert np.abs(rubbing.position - plain.position)[moving].max() < 2e-4


def test_speed_and_current_stay_within_their_limits_and_integrals_do_not_wind_up(with_component):
    rig = with_component("servo_screw").with_values(
        {"cylinder.speed_limit": 0.05, "cylinder.current_limit": 0.5, "load.damping": 0.0}
    )
    times = np.arange(0.0, 8.0, 0.01)
    signals = _rolled(rig, np.full(times.size, 10.0), times)
    assert signals.current.max() == pytest.approx(0.4 + 0.5)
    early = times <= 0.1  # all of the current
    assert_allclose(
        signals.position[early], 0.5 * PER_AMP * 0.5 / MASS * times[early] ** 2, rtol=1e-5, atol=1e-12
    )
    cruising = (times > 0.8) & (times < 1.5)
    assert_allclose(signals.velocity[cruising], 0.05, rtol=0.02)
    assert signals.position.max() < 0.1 * 1.05  # 160 s mm of error would be in an integral that wound up
    assert signals.position[-1] == pytest.approx(0.1, abs=1e-4)


def test_a_drive_that_carries_a_load_rests_where_it_is(with_component):
    rig = with_component("servo_screw").with_values(
        {"load.gravity_cos": 300.0, "cylinder.set_point_neutral": 0.04, "load.initial_position": 0.04}
    )
    for integral in ("position_time", "speed_time"):
        one = rig.with_values({f"cylinder.{integral}": 0.0})
        times = np.arange(0.0, 2.0, 0.01)
        signals = _rolled(one, np.zeros(times.size), times)
        assert_allclose(signals.position, 0.04, atol=1e-9)
        assert_allclose(signals.current, 0.4 + 300.0 / PER_AMP, rtol=1e-6)


def test_a_reversed_axis_turns_its_set_point_and_keeps_the_current_s_size(with_component):
    rig = with_component("servo_screw")
    times = np.arange(0.0, 1.0, 0.01)
    forward = _rolled(rig, np.full(times.size, 0.5), times)
    back = _rolled(rig.with_values({"linkage.direction": -1.0}), np.full(times.size, 0.5), times)
    assert_allclose(back.position, -forward.position, atol=1e-15)
    assert_allclose(back.current, forward.current, rtol=1e-12)


def test_force_is_not_regressed_on_a_drive_whose_command_is_no_force(with_component):
    with pytest.raises(InputError, match="use hydrolek fit"):
        motor_joint(with_component("servo_screw"))


def test_the_diagram_has_the_same_current(with_component):
    rig = with_component("servo_screw").with_values(
        {
            "load.gravity_cos": 150.0,
            "effects.load.coulomb_friction.force_N": 100.0,
            "load.friction_velocity": 5e-3,
        }
    )
    times = np.arange(0.0, 3.0, 0.01)
    volts = np.interp(times, [0.0, 1.2, 1.8, 3.0], [0.0, 3.0, 3.0, 0.0])
    driven = Driven("axis", times, volts, None)
    (moved,) = moved_by_diagram(rig, [driven], times, {}).values()
    alone = _rolled(rig, volts, times)
    behind = times > 0.05
    assert np.ptp(alone.current) > 0.2
    assert_allclose(moved.signals.current[behind], alone.current[behind], atol=4e-3)
    assert_allclose(moved.signals.position, alone.position, atol=2e-5)
