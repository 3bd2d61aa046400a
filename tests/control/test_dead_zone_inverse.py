"""The inverse dead-zone inverts the static nonlinearity; the scaled input maps as Table 6.3 says."""

import pytest

from hydrolek_drake.control.laws.inverse_dead_zone import inverse_dead_zone
from hydrolek_drake.control.laws.scaled_input import DirectInput
from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_model
from hydrolek_drake.control.thesis_gains import scaled_input

JOINTS = ("j1", "j2", "j3", "j4", "j4_linear")
OUTPUTS = (-1.5, -0.7, -0.0501, 0.0501, 0.3, 1.2)


@pytest.mark.parametrize("output", OUTPUTS)
@pytest.mark.parametrize("joint", JOINTS)
def test_the_inverse_is_exact_outside_the_chatter_band(joint, output):
    inverse = inverse_dead_zone(thesis_model(joint), 10.0)
    assert inverse.increment(inverse.voltage(output)) == pytest.approx(output, abs=1e-12)


@pytest.mark.parametrize("joint", JOINTS)
def test_the_valve_stays_shut_within_the_chatter_band(joint):
    inverse = inverse_dead_zone(thesis_model(joint), 10.0)
    assert inverse.voltage(inverse.chatter) == 0.0 == inverse.voltage(-inverse.chatter)


@pytest.mark.parametrize("joint", JOINTS)
def test_one_degree_a_sample_is_met_exactly_by_the_model_too(joint):
    """The secant of figure 6.6 ends on the SDP curve at 20 deg/s."""
    model = thesis_model(joint)
    inverse = inverse_dead_zone(model, 10.0)
    assert model.rate(inverse.voltage(1.0)) == pytest.approx(20.0)
    assert model.rate(inverse.voltage(-1.0)) == pytest.approx(-20.0)


def test_a_slow_joint_is_linearised_below_its_saturation():
    slow = SdpModel("slow", (-0.1, 1.5, -1.0, 0.15, 1.5, 1.0), None, 0.01, 15, -30.0, 30.0)
    inverse = inverse_dead_zone(slow, 10.0)
    assert slow.rate(inverse.voltage(15.0 * 0.05 * 0.9)) == pytest.approx(13.5)
    assert slow.rate(inverse.voltage(-10.0 * 0.05 * 0.9)) == pytest.approx(-9.0)


def test_voltages_stay_within_the_field_points_range():
    inverse = inverse_dead_zone(thesis_model("j1"), 10.0)
    assert inverse.voltage(1e6) == 10.0
    assert inverse.voltage(-1e6) == -10.0
    assert DirectInput(10.0).voltage(12.0) == 10.0
    low, high = inverse.limits
    assert inverse.voltage(low) == pytest.approx(-10.0)
    assert inverse.voltage(high) == pytest.approx(10.0)


@pytest.mark.parametrize(
    ("signal", "voltage"),
    [
        (0.0, 0.0),
        (50.0, 1.3 + 50 * 0.0119),
        (100.0, 2.3),
        (500.0, 2.3),
        (-50.0, -1.36 - 50 * 0.0117),
        (-100.0, -2.3),
    ],
)
def test_scaling_of_joint_2_by_6_7_and_6_8(signal, voltage):
    assert scaled_input("j2").voltage(signal) == pytest.approx(voltage)
