"""Feedforward rate control: its parts, its difference equation, and the objectives on the full model."""

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import build_law, rig_setting
from hydrolek_drake.control.closed_loop import loop_on_model, loop_on_rollout
from hydrolek_drake.control.conditions import Condition, machine, span_deg
from hydrolek_drake.control.feedforward import FeedforwardLaw, tuning
from hydrolek_drake.control.metrics import step_measures
from hydrolek_drake.control.rate_map import map_from_model, rate_at, voltage_for
from hydrolek_drake.control.rig_model import fit_law, one_joint, step_tests
from hydrolek_drake.control.sdp_model import thesis_model
from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import load_rig

JOINTS = ("j1", "j2", "j3", "j4")


@pytest.mark.parametrize("joint", JOINTS)
@pytest.mark.parametrize("sign", (-1.0, 1.0))
def test_the_rate_map_inverts_the_law_it_comes_from(joint, sign):
    model = thesis_model(joint)
    side = map_from_model(model).side(sign)
    for rate in np.linspace(0.5, 0.95 * side.fastest, 12):
        voltage = voltage_for(side, rate)
        assert rate_at(side, voltage) == pytest.approx(rate)
        assert abs(float(model.rate(sign * voltage))) == pytest.approx(rate, rel=0.02, abs=0.1)


def _law(joint):
    model = thesis_model(joint)
    return FeedforwardLaw(map_from_model(model), 0.05, 10.0, tuning()), model


@pytest.mark.parametrize("joint", JOINTS)
def test_on_the_model_it_was_made_for_it_lands_on_the_set_point(joint):
    law, model = _law(joint)
    for target in (20.0, -8.0):
        signals = loop_on_model(law, model, np.full(100, target), 0.05)
        measures = step_measures(signals.time_s, signals.angle_deg, 0.0, target, last_s=2.0, still_deg=0.01)
        assert measures.error_deg <= law.tuning.start_beyond_deg
        assert measures.overshoot_percent < 3.0
        assert np.all(signals.voltage_V[-200:] == 0.0)


def test_a_steadily_moving_set_point_is_followed_without_lag():
    law, model = _law("j2")
    wanted = 8.0 * np.arange(80) * 0.05
    signals = loop_on_model(law, model, wanted, 0.05)
    between = 8.0 * signals.time_s[200:]  # the set point also between its samples
    assert np.max(np.abs(signals.angle_deg[200:] - between)) < 0.01


def test_the_difference_equation_written_out_plainly():
    """One sample at a time, with the map as straight lines: the same voltages."""
    law, model = _law("j2")
    t, tune = 0.05, law.tuning
    delay = (model.delay_samples * model.sample_s + tune.extra_delay_s) / t
    whole = int(delay + 1e-9)
    rest = delay - whole
    side = {s: law.map.side(s) for s in (-1.0, 1.0)}
    share, edge = {-1.0: 1.0, 1.0: 1.0}, {-1.0: 0.0, 1.0: 0.0}
    sent, estimates, standing = [0.0] * 12, [0.0] * 3, False
    rng = np.random.default_rng(8)
    state, angle = law.initial(0.0), 0.0

    def rate(v):
        if v == 0.0:
            return 0.0
        s = float(np.sign(v))
        size = float(np.interp(abs(v) - edge[s], side[s].voltages, side[s].rates))
        return s * size * share[s]

    plant = 0.0
    for k in range(120):
        wanted = 0.0 if k < 1 else 25.0 if k < 60 else -6.0
        measured = plant + float(rng.normal(0.0, 0.05))
        # angle, prediction
        rates = [rate(v) for v in reversed(sent)]
        angle += t * ((1 - rest) * rates[whole] + rest * rates[whole + 1])
        angle += tune.correction * (measured - angle)
        acting = rates[whole : whole + 4]
        got = (angle - estimates[-3]) / (3 * t)
        ahead = angle + t * (sum(rates[:whole]) + rest * rates[whole])
        # learning
        low, high = min(acting), max(acting)
        if low * high >= 0.0 and (low or high):
            s = float(np.sign(low + high))
            expected, saturated = abs(np.mean(acting)), 0.85 * side[s].fastest * share[s]
            if min(abs(low), abs(high)) >= saturated:
                ratio = min(max(got * s / expected, 0.0), 2.0)
                share[s] = float(np.clip(share[s] * (1 + tune.learn_rate * (ratio - 1)), 0.5, 2.0))
            elif max(abs(low), abs(high)) < saturated:
                slope = side[s].rates[1] / (side[s].voltages[1] - side[s].voltages[0])
                edge[s] += tune.learn_edge * (expected - got * s) / slope
                edge[s] = float(np.clip(edge[s], -0.5 * side[s].voltages[0], 0.5 * side[s].voltages[0]))
        # wanted rate
        distance, error, v = wanted - ahead, wanted - angle, 0.0
        if standing and abs(error) <= tune.start_beyond_deg:
            pass
        elif abs(distance) <= tune.stop_within_deg:
            standing = True
        else:
            standing = False
            s = float(np.sign(distance))
            far = abs(distance)
            want = min(tune.gain * far, side[s].fastest * np.sqrt(far / tune.braking_deg))
            want = min(max(want, tune.slowest), 2.0 * side[s].fastest) / share[s]
            size = float(np.interp(want, side[s].rates, side[s].voltages)) + edge[s]
            if want >= side[s].fastest:
                size = max(size, tune.overdrive * side[s].voltages[-1])
            opened = max(s * sent[-1], side[s].voltages[0] + edge[s])
            v = s * min(size, opened + tune.opening_V, 10.0)
        state, _, voltage = law.step(state, wanted, measured)
        assert voltage == pytest.approx(v, abs=1e-9), k
        sent = [*sent[1:], voltage]
        estimates = [*estimates, angle]
        for i in range(5):
            past = k * 5 + i + 1 - model.delay_samples
            held = [*sent][::-1]
            back = k - past // 5 if past >= 0 else 11
            plant = model.step(plant, held[back] if back < 12 else 0.0)


@pytest.fixture(scope="module")
def settings():
    return {j: rig_setting(load_rig(f"hydrolek_{j}"), j) for j in ("right_j2", "right_j3", "left_j5")}


CONDITIONS = (
    Condition("stretched", 0.0),
    Condition("stretched", 50.0),
    Condition("folded", 0.0),
    Condition("folded", 50.0),
)


@pytest.mark.parametrize("condition", CONDITIONS, ids=str)
@pytest.mark.parametrize("joint", ("right_j2", "right_j3", "left_j5"))
def test_the_aim_is_met_on_the_full_model(settings, joint, condition):
    """Rise within 15 % of saturation, overshoot under 2 %, error under 0.1 deg, both directions, with noise."""
    record = machine(joint, condition)
    for begin, end in (span_deg(joint), span_deg(joint)[::-1]):
        rng = np.random.default_rng(6)
        signals = loop_on_rollout(
            build_law("feedforward", settings[joint], noisy=True),
            record,
            np.full(120, end),
            0.05,
            rows_per_sample=5,
            longest_step=5e-4,
            initial_deg=begin,
            noise=lambda angle, rng=rng: angle + float(rng.normal(0.0, 0.05)),
        )
        full = loop_on_rollout(
            _Full(10.0 * np.sign(end - begin)),
            record,
            np.full(40, end),
            0.05,
            rows_per_sample=5,
            longest_step=5e-4,
            initial_deg=begin,
        )
        reached = step_measures(signals.time_s, signals.angle_deg, begin, end, last_s=2.0, still_deg=0.4)
        possible = step_measures(full.time_s, full.angle_deg, begin, end, last_s=0.1, still_deg=99.0)
        assert reached.rise_s < 1.15 * possible.rise_s
        assert reached.overshoot_percent < 2.0
        assert reached.error_deg < 0.1


class _Full:
    """Full voltage, whatever happens."""

    size = 0

    def __init__(self, voltage):
        self.voltage = voltage

    def initial(self, measured_deg):
        return np.zeros(0)

    def step(self, state, set_point_deg, measured_deg):
        return state, 0.0, self.voltage


def test_step_tests_find_the_rigs_dead_zone_and_rates():
    """The rigs were set up for Table 6.1's dead-zones and saturation rates."""
    record = one_joint(load_rig("hydrolek_right_j2"), "right_j2")
    tests = step_tests(record, 5e-4)
    assert np.max(tests.rate_deg_per_s) == pytest.approx(38.87, rel=0.05)
    assert np.min(tests.rate_deg_per_s) == pytest.approx(-29.51, rel=0.05)
    still = tests.voltage_V[tests.rate_deg_per_s == 0.0]
    assert np.max(still) == pytest.approx(1.3124, abs=0.1)
    assert np.min(still) == pytest.approx(-1.3298, abs=0.1)
    alpha = fit_law(tests, 0.01)
    assert alpha[0] * 100.0 == pytest.approx(-29.51, rel=0.1)
    assert alpha[3] * 100.0 == pytest.approx(38.87, rel=0.1)


def test_unknown_joints_and_postures_are_refused():
    with pytest.raises(InputError, match="no joint 'right_j9'"):
        one_joint(load_rig("hydrolek_right_j2"), "right_j9")
    with pytest.raises(InputError, match="no posture 'bent'"):
        machine("right_j2", Condition("bent"))
