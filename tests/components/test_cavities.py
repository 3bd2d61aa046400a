"""Cavities that oil has to fill again: the volume is kept; both executions stand in `test_component_executions`."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from hydrolek_drake.identification.experiments.channel import Channel
from hydrolek_drake.physics import cavity, cylinder, linkage
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.kernel import PULLED
from hydrolek_drake.rollout.rest import rest_state

SPEED = 2.0  # rad/s: a joint that swings behind a closed valve, and takes more oil than its chambers have
TIMES = np.arange(0.0, 0.5, 5e-4)


@pytest.fixture(scope="module")
def swung():
    """What a joint does that begins to turn behind its closed valve, and its record."""

    def swing(refilled, pull=None, effect=0.0, step=1e-4):
        rig = load_rig("joint_bench").with_values(
            {
                "fluid.cavity_refilled": refilled,
                "fluid.floor_time": 0.0,
                "effects.cylinder.cavitation.refilled": effect,
            }
        )
        record = rig.records()[:1]
        state = rest_state(record)
        state[5] = state[10] = SPEED
        volts = np.zeros_like(TIMES)
        return roll_out(
            record, TIMES, volts, TIMES, longest_step=step, state=state, pull=pull
        ).signals, record

    return swing


def oil_gained(signals, record, at=None):
    """Oil of both chambers beyond that at the start, B ln(V/V_0) + p - p_0 [Pa], where they have pressure; or A's."""
    joint = record.view(np.recarray)[0]
    stroke = np.array([linkage.stroke_and_lever(q, joint)[0] for q in signals.position])
    c, bulk_modulus = joint.cylinder, joint.fluid.bulk_modulus
    volumes = (c.dead_volume_a + c.area_a * stroke, c.dead_volume_b + c.area_b * (c.stroke - stroke))
    gained = []
    for volume, pressure in zip(volumes, (signals.pressure_a, signals.pressure_b), strict=True):
        content = bulk_modulus * np.log(volume / volume[0]) + pressure - pressure[0]
        if at is not None:
            return content[at]
        gained.append(content[pressure > 1e3])
    return np.concatenate(gained)


def test_a_closed_chamber_keeps_its_oil_through_cavities(swung):
    signals, record = swung(1.0)
    assert min(np.mean(signals.pressure_a == 0.0), np.mean(signals.pressure_b == 0.0)) > 0.1
    assert np.abs(oil_gained(signals, record)).max() < 1e3  # Pa, of pressures of some 10 MPa


def test_pressures_that_are_only_held_at_zero_gain_oil(swung):
    """So that the next swing is stopped earlier, and another way."""
    signals, record = swung(0.0)
    assert oil_gained(signals, record).max() > 1e7


def test_a_cavity_takes_as_much_oil_as_it_is_large():
    """The piston leaves a closed chamber of 40 ml three times as large; then oil flows in until it has pressure."""
    joint = load_rig("joint_bench").with_values({"fluid.cavity_refilled": 1.0}).records().view(np.recarray)[0]
    c, flow, speed = joint.cylinder, 1e-4, 0.05
    begin = (40e-6 - c.dead_volume_a) / c.area_a
    way = 80e-6 / c.area_a

    def emptied(t, p):
        return cylinder.pressure_rates(p[0], 1e6, 0.0, 0.0, begin + speed * t, speed, joint)[0]

    def filled(t, p):
        return cylinder.pressure_rates(p[0], 1e6, flow, 0.0, begin + way, 0.0, joint)[0]

    def full(t, p):
        return p[0]

    full.terminal = True
    exact = {"rtol": 1e-9, "atol": 1.0}
    empty = solve_ivp(emptied, (0.0, way / speed), [0.0], **exact).y[0, -1]
    assert empty == pytest.approx(-2.0 / 3.0 * joint.fluid.bulk_modulus, rel=1e-6)
    taken = flow * solve_ivp(filled, (0.0, 2.0), [empty], events=full, **exact).t_events[0][0]
    assert taken == pytest.approx(80e-6, rel=1e-6)


@pytest.mark.parametrize("step", [1e-4, 8e-4])
def test_hardly_any_of_a_cavity_is_hardly_anything(swung, step):
    """What the pressure falls below zero within a step is no cavity: 20 kPa are a gauge's noise."""
    none, _ = swung(0.0, step=step)
    some, _ = swung(1e-9, step=step)
    np.testing.assert_allclose(some.pressure_a, none.pressure_a, atol=20e3)
    np.testing.assert_allclose(some.pressure_b, none.pressure_b, atol=20e3)


def test_a_share_of_the_first_cavity_is_filled_again(swung):
    """What is forgotten of it is oil that nobody brought; all of it where pressures are only held at zero."""
    gained = {}
    for share in (0.0, 0.3, 0.7):
        signals, record = swung(share)
        empty = np.flatnonzero(signals.pressure_a == 0.0)[0]
        filled = empty + np.flatnonzero(signals.pressure_a[empty:] > 1e3)[0]
        gained[share] = oil_gained(signals, record, filled)
    for share in (0.3, 0.7):
        assert gained[share] == pytest.approx((1.0 - share) * gained[0.0], rel=0.03)


@pytest.mark.parametrize(("rig", "effect"), [(0.0, 0.7), (0.3, 0.4), (0.7, 0.0)])
def test_the_effect_is_what_the_rig_s_number_lacks(swung, rig, effect):
    found, expected = swung(rig, effect=effect)[0], swung(0.7)[0]
    np.testing.assert_allclose(found.position, expected.position, atol=1e-12)
    np.testing.assert_allclose(found.pressure_a, expected.pressure_a, atol=1e-3)


def test_no_more_than_a_whole_cavity_is_refilled(swung):
    np.testing.assert_array_equal(swung(1.0, effect=1.0)[0].pressure_a, swung(1.0)[0].pressure_a)


def test_pressures_are_never_told_below_zero(swung):
    signals, _ = swung(1.0)
    assert min(signals.pressure_a.min(), signals.pressure_b.min()) == 0.0


def test_an_observer_of_the_right_model_changes_nothing(swung):
    """A cavity is no difference from a measured pressure of zero, by which it would be filled."""
    free, _ = swung(1.0)
    measured = np.stack([free.position, free.pressure_a, free.pressure_b], axis=1)
    assert measured.shape[1] == len(PULLED)
    pulled, _ = swung(1.0, (0.05, measured))
    np.testing.assert_allclose(pulled.position, free.position, atol=1e-9)
    np.testing.assert_allclose(pulled.pressure_a, free.pressure_a, atol=10.0)


@pytest.mark.parametrize("state", [-1e6, -200e6])
def test_a_gauge_that_shows_pressure_says_that_there_is_no_cavity(state):
    """What was wrongly thought a cavity is forgotten as any error of an observer: to 1/e in a time constant."""
    measured, share, now = 5e6, 1.0 - np.exp(-0.1), state
    for _ in range(30 + int(np.ceil(10 * np.log(1.0 - state / measured)))):
        now = cavity.pulled(now, share, measured)
    assert now == pytest.approx(measured, rel=0.05)


@pytest.mark.parametrize("measured", [0.0, -0.05e6, np.nan])
def test_a_gauge_that_shows_none_says_nothing_of_a_cavity(measured):
    assert cavity.pulled(-3e6, 0.3, measured) == -3e6
    assert cavity.pulled(0.01e6, 1.0, measured) >= 0.0


def test_a_pressure_that_noise_does_not_tell_from_zero_is_none():
    gauge = Channel(
        "joint.pressure_a", "Pa", "pressure_a", np.array([0.05e6, -0.05e6, 0.07e6, np.nan]), 0.02e6
    )
    np.testing.assert_array_equal(gauge.measured_beyond_noise, [0.0, 0.0, 0.07e6, np.nan])


def test_where_no_pressure_comes_to_zero_nothing_changes():
    rig = load_rig("joint_bench").with_values({"fluid.floor_time": 0.0})
    times = np.arange(0.0, 1.0, 1e-2)
    found = []
    for share in (0.0, 1.0):
        record = rig.with_values({"fluid.cavity_refilled": share}).records()[:1]
        found.append(roll_out(record, times, np.full_like(times, 1.5), times, longest_step=1e-3).signals)
    assert found[0].pressure_a.min() > 0.0 and found[0].pressure_b.min() > 0.0
    np.testing.assert_array_equal(found[0].pressure_b, found[1].pressure_b)
