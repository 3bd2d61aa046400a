"""Where a signal moves, a sample whose moment is uncertain says less."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.identification.experiments.channel import Channel
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig

TIME = np.arange(0.0, 10.0, 0.01)
CLOCK_S = 5e-4


def _pressure(measured: np.ndarray, noise: float) -> Channel:
    return Channel("joint.pressure_a", "Pa", "pressure_a", measured, noise)


def test_a_deviation_is_that_of_samples_taken_at_moments_that_are_off():
    """A pressure that swings by 1 MPa at 2 Hz, sampled by a clock that is off by 0.5 ms at random."""
    rng = np.random.default_rng(5)
    noise, swing, rate = 2e3, 1e6, 4.0 * np.pi

    def pressure(at: np.ndarray) -> np.ndarray:
        return swing * np.sin(rate * at)

    off = np.array(
        [
            pressure(TIME + rng.normal(0.0, CLOCK_S, TIME.size)) + rng.normal(0.0, noise, TIME.size)
            for _ in range(400)
        ]
    ) - pressure(TIME)
    deviation = _pressure(pressure(TIME), noise).timed(TIME, CLOCK_S).deviation
    steep = np.abs(np.cos(rate * TIME)) > 0.9
    assert_allclose(deviation[steep], off.std(axis=0)[steep], rtol=0.15)
    at_rest = np.argmax(pressure(TIME))
    assert deviation[at_rest] == pytest.approx(noise, rel=0.05)


def test_no_error_changes_nothing():
    channel = _pressure(1e6 * np.sin(TIME), 2e3)
    assert channel.timed(TIME, 0.0) is channel


def test_what_was_not_measured_has_no_slope_of_its_own():
    measured = 1e5 * TIME
    measured[300:320] = np.nan
    deviation = _pressure(measured, 2e3).timed(TIME, CLOCK_S).deviation
    assert_allclose(deviation, np.hypot(2e3, 1e5 * CLOCK_S))


def test_a_rig_states_it():
    rig = load_rig("hopsan_link", {"integration.time_error": "0.5 ms"})
    angle = 0.1 * np.sin(TIME)
    signals = {
        "joint.command": np.sin(5.0 * TIME),
        "joint.angle": angle,
        "joint.pressure_a": 1e6 * np.sin(TIME),
    }
    [experiment] = experiments_of(rig, Recording("made", TIME, signals, "made.csv"))
    for channel, size in zip(experiment.channels, (0.1, 1e6), strict=True):
        fastest = size * CLOCK_S
        assert channel.deviation[0] == pytest.approx(np.hypot(channel.noise, fastest), rel=1e-3)
    begun = experiment.channels[1].until(10)
    assert_allclose(begun.deviation, experiment.channels[1].deviation[:10])
