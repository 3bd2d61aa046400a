"""Table 6.1 and Table 6.7 from step tests made with them; refined instrumental variables; dead times."""

import numpy as np
import pytest

from hydrolek_drake.control.models.sdp_model import SdpModel, thesis_model
from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sdp import identify_sdp
from hydrolek_drake.identification.sdp.dead_time import dead_time_samples
from hydrolek_drake.identification.sdp.refined_iv import first_order_estimate, integrator_estimate
from hydrolek_drake.identification.sdp.step_test import StepTest, campaign_data, step_tests_of
from hydrolek_drake.identification.sdp.validation import KINDS, random_voltage, validate
from hydrolek_drake.recordings import Recording

NOISE_DEG = 0.05


def campaign_of(model: SdpModel, rng, delay_of=None, more=()):
    """Step tests of 6.1.1 made with an SDP model, from near the end that each leaves."""
    plan = campaign_data()
    step = round(plan["rest"]["value"] / model.sample_s)
    count = step + round(plan["duration"]["value"] / model.sample_s)
    tests = []
    for level in map(float, [*plan["levels_V"], *more]):
        voltage = np.where(np.arange(count) < step, 0.0, level)
        start = model.lower_deg + 5.0 if level > 0.0 else model.upper_deg - 5.0
        used = model if delay_of is None else SdpModel(**{**model.__dict__, "delay_samples": delay_of(level)})
        angle = used.simulate(voltage, start) + NOISE_DEG * rng.standard_normal(count)
        tests.append(StepTest(model.sample_s, voltage, angle, step))
    return tests


@pytest.mark.parametrize("joint", ["j1", "j2", "j3", "j4"])
@pytest.mark.parametrize("seed", range(3))
def test_table_6_1_is_recovered_within_3_percent_from_noisy_step_tests(joint, seed):
    truth = thesis_model(joint)
    tests = campaign_of(truth, np.random.default_rng(seed))
    found = identify_sdp(joint, tests, truth.lower_deg, truth.upper_deg, 10.0)
    np.testing.assert_allclose(found.exponential.values, truth.alpha, rtol=0.03)
    assert found.model.delay_samples == truth.delay_samples
    assert {step.level_V for step in found.steps if step.moving} == {
        level for level in map(float, campaign_data()["levels_V"]) if truth.increment(level) != 0.0
    }
    for step in found.steps:
        if step.moving:
            assert step.a1 == pytest.approx(-1.0, abs=0.01)


def test_table_6_7_is_recovered_from_its_own_step_tests_with_finer_levels():
    truth = thesis_model("j4_linear")
    assert truth.beta is not None
    finer = [sign * level for sign in (-1.0, 1.0) for level in (1.2, 1.3, 1.4, 1.6, 1.7, 1.8, 1.9)]
    tests = campaign_of(truth, np.random.default_rng(0), more=finer)
    alpha, beta = identify_sdp("j4", tests, truth.lower_deg, truth.upper_deg, 10.0).linear
    np.testing.assert_allclose(alpha.values, truth.alpha, rtol=0.03)
    for place in (0, 2, 4, 5):
        assert beta.values[place] == pytest.approx(truth.beta[place], rel=0.03)
    for place in (1, 3):  # only bracketed by the levels
        assert abs(beta.values[place] - truth.beta[place]) <= beta.errors[place] < 0.1


def test_a_line_of_which_only_one_step_lies_below_saturation_is_not_claimed_to_be_known():
    truth = thesis_model("j4_linear")  # positive side: 1.5 V moves on the line, 2 V saturates
    tests = campaign_of(truth, np.random.default_rng(0))
    alpha, _ = identify_sdp("j4", tests, truth.lower_deg, truth.upper_deg, 10.0).linear
    assert np.isfinite(alpha.errors[:2]).all() and np.isinf(alpha.errors[2:]).all()
    np.testing.assert_allclose(alpha.values[:2], truth.alpha[:2], rtol=0.03)


def test_inverse_dead_zone_has_the_edges_and_moves_20_deg_per_s_at_its_ends():
    truth = thesis_model("j2")
    found = identify_sdp(
        "j2", campaign_of(truth, np.random.default_rng(1)), truth.lower_deg, truth.upper_deg, 10.0
    )
    inverse = found.inverse
    assert (inverse.edge_negative_V, inverse.edge_positive_V) == pytest.approx(
        (truth.alpha[2], truth.alpha[5]), rel=0.03
    )
    for degrees in (-1.0, 1.0):  # per control sample of 0.05 s: 20 deg/s
        assert truth.rate(inverse.voltage(degrees)) == pytest.approx(20.0 * degrees, rel=0.03)


def test_dead_time_of_each_step_is_found_where_it_grows_towards_the_dead_zone():
    truth = thesis_model("j2")
    tests = campaign_of(truth, np.random.default_rng(2), lambda level: 12 + round(10.0 / abs(level)))
    found = identify_sdp("j2", tests, truth.lower_deg, truth.upper_deg, 10.0)
    for step in found.steps:
        if step.moving:
            assert step.dead_time_s == pytest.approx(0.01 * (12 + round(10.0 / abs(step.level_V))), abs=0.006)


def test_refined_instrumental_variables_have_no_bias_where_least_squares_has():
    rng = np.random.default_rng(3)
    voltage = np.repeat(rng.uniform(-5.0, 5.0, 60), 20)
    clean = np.zeros(len(voltage))
    for k in range(1, len(clean)):
        clean[k] = 0.9 * clean[k - 1] + 0.2 * (voltage[k - 3] if k >= 3 else voltage[0])
    estimates, plain = [], []
    for _ in range(20):
        angle = clean + 1.5 * rng.standard_normal(len(clean))
        found = first_order_estimate(angle, voltage, 3)
        estimates.append([found.a1, found.b])
        regressors = np.column_stack([-angle[2:-1], voltage[: len(angle) - 3]])
        plain.append(np.linalg.lstsq(regressors, angle[3:], rcond=None)[0])
    assert np.mean(estimates, axis=0) == pytest.approx([-0.9, 0.2], rel=0.02)
    assert abs(np.mean(plain, axis=0)[0] + 0.9) > 0.05


def test_standard_error_of_b_is_that_of_repeated_tests():
    rng = np.random.default_rng(4)
    voltage = np.where(np.arange(200) < 20, 0.0, 4.0)
    found = [
        integrator_estimate(0.1 * np.cumsum(voltage) + 0.05 * rng.standard_normal(200), voltage, 0)
        for _ in range(300)
    ]
    spread = np.std([estimate.b for estimate in found])
    assert np.mean([estimate.b_error for estimate in found]) == pytest.approx(spread, rel=0.15)
    assert np.mean([estimate.b for estimate in found]) == pytest.approx(0.1, rel=1e-4)


def test_dead_time_between_samples():
    time = np.arange(300) * 0.01
    voltage = np.where(time < 0.1 - 1e-9, 0.0, 2.0)
    angle = np.maximum(time - 0.1 - 0.154, 0.0) * 20.0
    assert dead_time_samples(angle, voltage, 60) == pytest.approx(15.4 + 1.0, abs=0.6)


def test_validation_of_a_model_against_itself_leaves_the_noise():
    model = thesis_model("j2")

    def machine(voltage, sample, start, rng):
        return model.simulate(voltage, start) + NOISE_DEG * rng.standard_normal(len(voltage))

    runs = validate(model, machine, np.random.default_rng(0))
    assert [run.kind for run in runs] == [KINDS[0]] * 3 + [KINDS[1]] * 3
    for run in runs:
        assert run.mean_squared_error == pytest.approx(NOISE_DEG**2, rel=0.05)
        assert len(run.voltage_V) == 30000


def test_second_kind_of_random_voltage_has_no_level_within_half_a_volt():
    model = thesis_model("j1")
    first, second = (random_voltage(kind, model, np.random.default_rng(0)) for kind in KINDS)
    assert np.abs(first).min() < 0.5 <= np.abs(second).min()
    slowest, fastest = model.saturation_deg_per_s
    for voltage in (first, second):
        rates = model.rate(voltage)
        assert rates.min() >= 0.9 * slowest - 1e-9 and rates.max() <= 0.9 * fastest + 1e-9


def _recording(time, voltage, angle_deg, tmp_path):
    signals = {"j.command": voltage, "j.angle": np.radians(angle_deg)}
    return Recording("steps", time, signals, tmp_path / "steps.csv")


def test_steps_are_found_in_one_long_recording(tmp_path):
    time = np.arange(600) * 0.01
    voltage = np.select([time < 1.0, time < 3.0, time < 4.0], [0.0, 2.0, 0.0], -3.0)
    tests = step_tests_of(_recording(time, voltage, 10.0 * time, tmp_path), "j", 0.01)
    assert [(test.before_V, test.level_V, test.step) for test in tests] == [(0.0, 2.0, 100), (0.0, -3.0, 100)]


def test_a_recording_without_steps_is_refused(tmp_path):
    time = np.arange(100) * 0.01
    with pytest.raises(InputError, match="constant at 2 V"):
        step_tests_of(_recording(time, np.full(100, 2.0), time, tmp_path), "j", 0.01)


def test_a_joint_that_never_moves_is_refused():
    rng = np.random.default_rng(0)
    model = thesis_model("j1")
    tests = [
        StepTest(0.01, test.voltage_V, 5.0 + 0.05 * rng.standard_normal(len(test.voltage_V)), test.step)
        for test in campaign_of(model, rng)
    ]
    with pytest.raises(InputError, match="no step moves the joint"):
        identify_sdp("j1", tests, -30.0, 40.0, 10.0)
