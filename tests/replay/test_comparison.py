"""The numbers and words of a comparison on residuals that are known."""

import numpy as np
import pytest

from hydrolek_drake.replay import compare, replay
from hydrolek_drake.replay.conditions import AFTER_REVERSAL_S, conditions_of, growth, shares
from hydrolek_drake.replay.noise import noise_level, samples_in, smoothed
from hydrolek_drake.replay.spans import worst_spans
from hydrolek_drake.replay.thinning import thinned
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout.rollout import Signals

TIME = np.arange(0.0, 40.0, 0.01)
MOVEMENT = 20.0 * np.sin(0.8 * TIME) + np.where(TIME > 13.0, 7.0, 0.0)


@pytest.mark.parametrize("resolution", [0.0, 0.02, 0.05])
def test_noise_is_found_under_movement_jumps_and_rounding(resolution):
    noisy = MOVEMENT + np.random.default_rng(1).normal(0.0, 0.05, TIME.size)
    expected = np.hypot(0.05, resolution / np.sqrt(12.0))
    if resolution:
        noisy = resolution * np.round(noisy / resolution)
    # 4000 samples: the deviation's own scatter is below 2 %, twice that for the trimming at 3.5 deviations
    assert noise_level(noisy) == pytest.approx(expected, rel=0.05)


def test_rounding_without_noise_counts_as_noise():
    step = 0.5
    assert noise_level(step * np.round(0.1 * TIME / step)) == pytest.approx(step / np.sqrt(12.0))


def test_noise_is_told_from_the_windows_in_which_a_joint_does_not_stick_and_slip():
    slipping = np.where(np.sin(0.8 * TIME) > 0.0, 0.3 * np.abs((7.0 * TIME) % 2.0 - 1.0), 0.0)
    noisy = MOVEMENT + slipping + np.random.default_rng(4).normal(0.0, 0.05, TIME.size)
    third = np.diff(noisy, n=3)
    assert np.sqrt(np.mean(third**2) / 20.0) > 1.2 * 0.05  # over the whole recording it looks larger
    # a tenth of a hundred windows of 17 degrees of freedom: 5 %, twice
    assert noise_level(noisy) == pytest.approx(0.05, rel=0.1)


def test_an_encoder_that_stands_still_half_of_the_time_says_nothing_of_noise_there():
    step, noise = 0.05, 0.01
    moved = np.where(TIME < 20.0, 5.0, 5.0 + 2.0 * (TIME - 20.0)) + np.random.default_rng(5).normal(
        0.0, noise, TIME.size
    )
    rounded = step * np.round(moved / step)
    assert noise_level(rounded) == pytest.approx(np.hypot(noise, step / np.sqrt(12.0)), rel=0.1)


@pytest.mark.parametrize("samples", [500, 1000, 4000])
def test_white_noise_is_not_taken_for_movement(samples):
    """All of it counts, so that the level scatters by less than the windows that happen to move least do."""
    rng = np.random.default_rng(samples)
    levels = np.array([noise_level(rng.normal(size=samples)) for _ in range(300)])
    trimmed = 0.997  # beyond 3.5 deviations of a first estimate
    assert levels.mean() == pytest.approx(trimmed, abs=0.01)
    assert levels.std() < 1.6 * np.sqrt(0.5 * 2.31 / samples)  # differences that overlap tell less


def test_noise_passes_over_missing_values():
    noisy = MOVEMENT + np.random.default_rng(2).normal(0.0, 0.05, TIME.size)
    noisy[np.random.default_rng(3).random(TIME.size) < 0.1] = np.nan
    assert noise_level(noisy) == pytest.approx(0.05, rel=0.06)


def test_constant_has_no_noise():
    assert noise_level(np.full(100, 3.0)) == 0.0


def test_smoothing_keeps_straight_lines_inside_and_gaps():
    values = 2.0 * TIME
    values[1000] = np.nan
    mean = smoothed(values, samples_in(0.1, TIME))
    assert np.isnan(mean[1000]) and np.isfinite(np.delete(mean, 1000)).all()
    np.testing.assert_allclose(mean[20:900], values[20:900], rtol=0, atol=1e-9)


def test_worst_spans_are_where_the_error_was_put_worst_first():
    residual = np.random.default_rng(4).normal(0.0, 0.05, TIME.size)
    residual[(TIME >= 10.0) & (TIME < 12.0)] += 3.0
    residual[(TIME >= 30.0) & (TIME < 31.0)] -= 2.0
    first, second = worst_spans(TIME, residual, 0.05)
    assert (first.start, first.end) == pytest.approx((10.0, 12.0), abs=0.06)
    assert (second.start, second.end) == pytest.approx((30.0, 31.0), abs=0.06)
    assert first.share == pytest.approx(18.0 / (18.0 + 4.0), abs=0.02)
    assert first.largest > 3.0 > 0.0 > -2.0 > second.largest


def test_noise_alone_has_no_worst_span():
    assert worst_spans(TIME, np.random.default_rng(5).normal(0.0, 0.05, TIME.size), 0.05) == ()


def test_shares_count_time_not_samples():
    time = np.concatenate([np.arange(0.0, 1.0, 0.001), np.arange(1.0, 10.0, 0.1)])
    error = np.ones(time.size)
    (early,) = shares(time, error, {"early": time < 1.0})
    assert early.of_time == pytest.approx(0.1, abs=0.01)
    assert early.of_error == pytest.approx(0.1, abs=0.01)


def test_error_grows_where_its_cause_acts_not_where_it_stays():
    acting = (TIME > 5.0) & (TIME < 7.0)
    residual = np.cumsum(acting) * 0.01
    (large,) = shares(TIME, residual, {"acting": acting})
    (grows,) = shares(TIME, growth(TIME, residual), {"acting": acting})
    assert large.of_error < 0.1
    assert grows.of_error > 0.9


def test_conditions_follow_the_models_movement():
    rig = load_rig("joint_bench")
    lower, upper = (rig.value(f"joints.joint.load.{name}") for name in ("lower_stop", "upper_stop"))
    middle, reach = 0.5 * (lower + upper), 0.5 * (upper - lower)
    position = middle + reach * np.sin(TIME)
    velocity = reach * np.cos(TIME)
    rest = np.zeros(TIME.size)
    signals = Signals(TIME, position, position, velocity, *[rest] * 6)
    holds = conditions_of(rig, "joint", 5.0 * np.cos(TIME), signals)
    up, down = (holds[f"while moving in the {way} direction"] for way in ("positive", "negative"))
    assert np.array_equal(holds["at rest"], ~(up | down))
    assert np.all(velocity[up] > 0.0) and np.all(velocity[down] < 0.0)
    assert np.all(position[holds["near the lower end"]] < lower + 0.1001 * (upper - lower))
    assert np.all(position[holds["near the upper end"]] > upper - 0.1001 * (upper - lower))
    assert np.all(np.abs(np.cos(TIME[holds["at high command"]])) > 0.799)
    turns = np.pi * (np.arange(13) + 0.5)
    since = np.array([t - turns[turns <= t].max() if (turns <= t).any() else np.inf for t in TIME])
    after = holds["just after a reversal"]
    crossing = np.arcsin(0.02) + 0.01  # the joint counts as moving again this long after it turned
    assert np.all(after[(since > crossing) & (since < AFTER_REVERSAL_S)])
    assert not np.any(after[since > AFTER_REVERSAL_S + crossing])


def test_leak_that_the_model_does_not_know_is_seen_and_placed(bench_recording):
    angle, pressure_a, pressure_b = compare(replay(load_rig("joint_bench"), bench_recording("practice_03")))
    for signal in (angle, pressure_a, pressure_b):
        assert not signal.agrees
        assert signal.rms_over_noise > 10.0
        assert 1 <= len(signal.spans) <= 5
        assert sum(span.share for span in signal.spans) <= 1.0 + 1e-12
        assert "% of the time" in signal.sentence()
    # a leak lets pressures settle where the closed valve should hold them
    at_rest = next(c for c in pressure_a.conditions if c.name == "at rest")
    assert at_rest.of_error > 0.5


def test_thinning_keeps_every_peak():
    values = np.random.default_rng(6).normal(size=100_000)
    time = np.arange(values.size, dtype=float)
    values[40_000:60_000] = np.nan
    few_times, few = thinned(time, values, 1000)
    assert few.size <= 1000
    assert np.all(np.diff(few_times) > 0.0)
    assert np.nanmax(few) == np.nanmax(values) and np.nanmin(few) == np.nanmin(values)
    assert np.isnan(few).any()
