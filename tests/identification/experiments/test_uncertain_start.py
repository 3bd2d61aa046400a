"""Where a joint rests at the beginning is a mean of noisy readings: what that error explains must not count."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig

RIG = "hydrolek_right_j2"
NOISE_DEG = 0.05
REST_S = 0.2


@pytest.fixture(scope="module")
def rig():
    return load_rig(RIG)


def _recording(rig, seed: int, begins_deg: float, creeps_deg_s: float = 0.0, volts: float = 3.0) -> Recording:
    """20 s of random voltage after a short rest; the readings creep at first, if they are to."""
    generator = np.random.default_rng(seed)
    time = np.arange(0.0, 20.0, 0.01)
    command = np.repeat(generator.uniform(-volts, volts, 40), 50)
    command[: round(REST_S / 0.01)] = 0.0
    blank = Recording(
        "made",
        time,
        {
            "right_j2.command": command,
            "right_j2.angle": np.radians(begins_deg) + 1e-3 * generator.standard_normal(time.size),
        },
        Path("made.csv"),
    )
    (experiment,) = experiments_of(rig, blank)
    played = replace(experiment, start=np.radians(begins_deg)).simulate(rig.records()).signals.reading
    creep = np.radians(creeps_deg_s) * np.minimum(time - REST_S, 0.0)
    noise = np.radians(NOISE_DEG) * generator.standard_normal(time.size)
    signals = {"right_j2.command": command, "right_j2.angle": played + creep + noise}
    return Recording("made", time, signals, Path("made.csv"))


def _chi_squared(rig, experiment, responding: bool) -> float:
    """Of the machine's own numbers, over the values."""
    signals = experiment.simulate(rig.records()).signals
    if responding:
        response = experiment.responding(rig.records(), experiment.longest_step, signals)
        experiment = replace(experiment, start_response=response)
    residuals = experiment.residuals(signals)
    return float(residuals @ residuals) / experiment.counted


def test_the_residuals_are_weighted_by_the_inverse_of_their_covariance(rig) -> None:
    (experiment,) = experiments_of(rig, _recording(rig, 1, 25.0))
    signals = experiment.simulate(rig.records()).signals
    plain = replace(experiment, start_error=0.0).residuals(signals)
    offset = experiment.start_error / experiment.channels[0].deviation * np.ones(plain.size)
    covariance = np.eye(plain.size) + np.outer(offset, offset)
    white = experiment.residuals(signals)
    assert white @ white == pytest.approx(plain @ np.linalg.solve(covariance, plain), rel=1e-9)


def test_what_is_far_off_is_not_excused_by_the_start(rig) -> None:
    (experiment,) = experiments_of(rig, _recording(rig, 1, 25.0))
    known = replace(experiment, start_error=0.0)
    signals = experiment.simulate(rig.records()).signals
    for off_deg in (1.0, 10.0):
        far = replace(signals, reading=signals.reading + np.radians(off_deg))
        plain, told = known.residuals(far), experiment.residuals(far)
        taken = np.degrees(np.abs(plain - told).max() * experiment.channels[0].noise)
        assert taken <= 3.01 * np.degrees(experiment.start_error)
        assert np.linalg.norm(told) > 0.8 * np.linalg.norm(plain)


def test_the_error_of_the_mean_is_told(rig) -> None:
    """Twenty readings: a standard deviation of 0.05 deg over the root of 20, and what their halves differ by."""
    starts = []
    for seed in range(12):
        (experiment,) = experiments_of(rig, _recording(rig, seed, 25.0))
        assert experiment.start is not None
        starts.append((np.degrees(experiment.start) - 25.0) / np.degrees(experiment.start_error))
        assert np.degrees(experiment.start_error) >= 0.9 * NOISE_DEG / np.sqrt(20)
    assert np.sqrt(np.mean(np.square(starts))) < 1.3


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_machine_that_is_right_is_at_the_noise_although_it_crept_at_first(rig, seed: int) -> None:
    """One chi-squared for each value, known to sqrt(2 / 2000) = 3 %; a start off by 0.05 deg would double it."""
    (experiment,) = experiments_of(rig, _recording(rig, seed, 25.0, creeps_deg_s=-0.5))
    known = replace(
        experiment.channels[0], noise=np.radians(NOISE_DEG)
    )  # a recording's own movement passes for some
    experiment = replace(experiment, channels=(known,))
    plain = _chi_squared(rig, replace(experiment, start_error=0.0), responding=False)
    told = _chi_squared(rig, experiment, responding=True)
    assert told == pytest.approx(1.0, abs=0.1)
    assert told < plain


def test_a_stop_ends_what_a_wrong_start_does(rig) -> None:
    (experiment,) = experiments_of(rig, _recording(rig, 4, 25.0, volts=9.0))
    signals = experiment.simulate(rig.records()).signals
    response = experiment.responding(rig.records(), experiment.longest_step, signals)
    assert response is not None
    assert response[0, 10] == pytest.approx(1.0, abs=0.05)
    assert np.abs(response[0, -200:]).max() < 0.2


def test_an_observer_forgets_the_start_where_a_free_rollout_does_not(rig) -> None:
    """Both rollouts of a response are pulled: else it would be what the observer corrects, which is no start's."""
    (experiment,) = experiments_of(rig, _recording(rig, 1, 25.0))
    records, step, pull = rig.records(), experiment.longest_step, 0.1
    free = experiment.responding(records, step, experiment.simulate(records).signals)
    followed = experiment.simulate(records, step, pull_time=pull).signals
    pulled = experiment.responding(records, step, followed, pull)
    late = experiment.time > experiment.time[0] + 20.0 * pull
    assert np.abs(pulled[0, late]).max() < 0.1 * np.abs(free[0, late]).max()
    mixed = experiment.responding(records, step, followed)
    assert np.abs(mixed[0, late]).max() > np.abs(pulled[0, late]).max()
