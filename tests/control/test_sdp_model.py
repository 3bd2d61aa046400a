"""The SDP model has the dead-zone, slopes and saturation of Table 6.1 and figure 6.3."""

import numpy as np
import pytest

from hydrolek_drake.control.models.sdp_model import exponential_rate, thesis_model
from hydrolek_drake.errors import InputError

JOINTS = ("j1", "j2", "j3", "j4", "j4_linear")


@pytest.mark.parametrize("joint", JOINTS)
def test_nothing_moves_in_the_dead_zone_and_the_rate_rises_outside(joint):
    model = thesis_model(joint)
    low, high = model.dead_zone_V
    assert np.all(model.rate(np.linspace(low + 1e-9, high - 1e-9, 50)) == 0.0)
    for outside in (np.linspace(-10.0, low - 0.02, 300), np.linspace(high + 0.02, 10.0, 300)):
        rates = model.rate(outside)
        assert np.all(np.sign(rates) == np.sign(outside))
        assert np.all(np.diff(rates) >= 0.0)


@pytest.mark.parametrize("joint", JOINTS)
def test_ten_volts_give_the_saturation_rates(joint):
    model = thesis_model(joint)
    assert model.rate([-10.0, 10.0]) == pytest.approx(model.saturation_deg_per_s, rel=1e-3)


def test_joint_2_saturates_at_the_rates_of_figure_6_3():
    assert thesis_model("j2").saturation_deg_per_s == pytest.approx((-29.51, 38.87))


@pytest.mark.parametrize("joint", ("j1", "j2", "j3", "j4"))
def test_the_exponential_law_is_continuous_and_has_its_slope_at_the_edges(joint):
    a1, a2, a3, a4, a5, a6 = thesis_model(joint).alpha
    step = 1e-6
    assert exponential_rate(a3 - step, thesis_model(joint).alpha) / step == pytest.approx(a1 * a2, rel=1e-5)
    assert exponential_rate(a6 + step, thesis_model(joint).alpha) / step == pytest.approx(a4 * a5, rel=1e-5)


def test_the_straight_lines_of_table_6_7_meet_their_saturation_values():
    model = thesis_model("j4_linear")
    assert model.beta is not None
    assert model.alpha[0] + model.alpha[1] * model.beta[4] == pytest.approx(model.beta[0], abs=1e-4)
    assert model.alpha[2] + model.alpha[3] * model.beta[5] == pytest.approx(model.beta[2], abs=1e-4)


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("rate", (-20.0, -16.0, 16.0, 20.0))
def test_voltage_at_inverts_the_rate(joint, rate):
    model = thesis_model(joint)
    assert model.rate(model.voltage_at(rate)) == pytest.approx(rate)


@pytest.mark.parametrize("joint", ("j2", "j4"))
def test_a_step_acts_after_the_dead_time_and_ends_at_the_stop(joint):
    model = thesis_model(joint)
    angles = model.simulate(np.full(1000, 10.0), initial_deg=0.0)
    moved = np.flatnonzero(angles > 0.0)
    assert moved[0] == model.delay_samples
    assert angles[moved[0]] == pytest.approx(model.saturation_deg_per_s[1] * model.sample_s, rel=1e-3)
    assert angles[-1] == model.upper_deg


def test_step_and_simulate_agree():
    model = thesis_model("j1")
    voltages = np.random.default_rng(3).uniform(-4.0, 4.0, 400)
    angle, angles = 5.0, [5.0]
    for k in range(1, len(voltages)):
        angle = model.step(angle, voltages[k - 15] if k >= 15 else 0.0)
        angles.append(angle)
    assert model.simulate(voltages, 5.0) == pytest.approx(np.array(angles), abs=1e-12)


def test_bad_requests_are_refused():
    with pytest.raises(InputError, match="choose j1, j2"):
        thesis_model("j9")
    with pytest.raises(InputError, match="no voltage gives 60 deg/s"):
        thesis_model("j2").voltage_at(60.0)
    with pytest.raises(InputError, match="cannot move as slowly as -7 deg/s"):
        thesis_model("j4_linear").voltage_at(-7.0)
