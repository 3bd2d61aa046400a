"""Signals with clocks of their own: which clock is everybody's, how they get there, and offsets between clocks."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings.one_clock import Sampled, on_one_clock
from hydrolek_drake.recordings.resampling import averaged, averaged_held


def moving_valve(rng, duration=60.0, dead_time=0.0):
    """A command that changes every second or so, and the position of what it drives, which lags by 50 ms besides."""
    fine = np.arange(0.0, duration, 1e-3)
    levels = rng.uniform(-5.0, 5.0, int(duration) + 1)
    command = levels[(fine + 0.3 * np.sin(fine)).astype(int)]
    late = np.interp(fine - dead_time, fine, command)
    speed = np.zeros_like(late)
    for i in range(1, fine.size):
        speed[i] = speed[i - 1] + (late[i - 1] - speed[i - 1]) * 1e-3 / 0.05
    return fine, command, np.cumsum(speed) * 1e-3


def sampled(clock, fine, values, rate, ahead=0.0):
    at = np.arange(0.0, fine[-1], 1.0 / rate)
    index = np.searchsorted(fine, at - 1e-9)
    return Sampled(clock, at + ahead, values[index])


@pytest.mark.parametrize("ahead", [-1000.0, -4.7, 3.2, 1.7e9])
def test_an_offset_between_clocks_is_found_from_the_data(ahead):
    """The answer's lag of 50 ms is found too: told apart from an offset it cannot be."""
    fine, command, position = moving_valve(np.random.default_rng(2))
    position = -position + np.random.default_rng(3).normal(0.0, 0.01, position.size)  # polarity is the rig's
    signals = {
        "j.command": sampled("drive", fine, command, 50.0),
        "j.position": sampled("daq", fine, position, 100.0, ahead),
    }
    time, on_it, told = on_one_clock(signals, None, dead_time=0.05)
    np.testing.assert_array_equal(time, signals["j.position"].time)  # the sensor's clock stays
    true = command[np.searchsorted(fine, time - ahead - 1e-9)]
    inside = np.isfinite(on_it["j.command"])
    assert inside.mean() > 0.98
    assert np.corrcoef(on_it["j.command"][inside], true[inside])[0, 1] > 0.98
    (offset,) = [finding for finding in told if finding.kind == "offset"]
    assert "moved by" in offset.message
    moved = float(offset.message.split("moved by ")[1].split(" s")[0])
    assert moved == pytest.approx(-ahead, abs=0.04)


@pytest.mark.parametrize("dead_time", [0.0, 0.2, 0.6])
def test_a_dead_time_that_a_machine_may_have_is_left_to_the_rig(dead_time):
    fine, command, position = moving_valve(np.random.default_rng(2), dead_time=dead_time)
    signals = {
        "j.command": sampled("drive", fine, command, 50.0),
        "j.position": sampled("daq", fine, position, 100.0),
    }
    time, on_it, told = on_one_clock(signals, None, 0.0)
    np.testing.assert_array_equal(
        on_it["j.command"], command[np.searchsorted(fine, np.floor(time / 0.02 + 1e-3) * 0.02 - 1e-9)]
    )
    (offset,) = [finding.message for finding in told if finding.kind == "offset"]
    assert "moved" not in offset
    lag = float(offset.split("by ")[1].split(" s")[0])
    assert lag == pytest.approx(dead_time + 0.05, abs=0.03)


def test_what_repeats_does_not_tell_by_how_many_periods_it_is_off():
    at = np.arange(0.0, 60.0, 0.01)
    signals = {
        "j.command": Sampled("drive", at, np.sin(2 * np.pi * at)),
        "j.position": Sampled("daq", at + 0.003, -np.cos(2 * np.pi * at)),
    }
    _, _, told = on_one_clock(signals, None, 0.0)
    assert not any("moved" in finding.message for finding in told)


def test_clocks_without_a_common_time_and_without_a_motion_that_tells_are_refused():
    rng = np.random.default_rng(5)
    at = np.arange(0.0, 20.0, 0.01)
    signals = {
        "j.command": Sampled("drive", at, rng.normal(size=at.size)),
        "j.position": Sampled("daq", at + 500.0, rng.normal(size=at.size)),
    }
    with pytest.raises(
        InputError, match=r"drive \(0 s to 19.99 s\) and daq \(500 s to 519.99 s\) have no time"
    ):
        on_one_clock(signals, None, 0.0)


def test_faster_signals_are_averaged_and_keep_what_they_integrate_to():
    slow, fast = np.arange(0.0, 10.0, 0.02), np.arange(0.0, 10.0, 0.001)
    rng = np.random.default_rng(7)
    pwm = (rng.random(fast.size) < 0.3).astype(float)
    hum = np.sin(2 * np.pi * 50.0 * fast)  # at 50 Hz sampling it would stand still at any value
    signals = {
        "j.angle": Sampled("encoder", slow, slow),
        "j.command": Sampled("pwm", fast, pwm),
        "j.pressure_a": Sampled("daq", fast, 1e5 + 1e6 * hum),
    }
    time, on_it, told = on_one_clock(signals, None, 0.0)
    np.testing.assert_array_equal(time, slow)
    assert np.sum(on_it["j.command"]) * 0.02 == pytest.approx(np.sum(pwm) * 0.001, rel=1e-9)
    np.testing.assert_allclose(on_it["j.pressure_a"][1:-1], 1e5, atol=1e3)
    assert sum("averaged over its steps" in finding.message for finding in told) == 2


def test_the_rig_chooses_another_clock():
    slow, fast = np.arange(0.0, 10.0, 0.02), np.arange(0.0, 10.0, 0.001)
    signals = {"j.angle": Sampled("encoder", slow, slow), "j.pressure_a": Sampled("daq", fast, fast)}
    time, on_it, told = on_one_clock(signals, "daq", 0.0)
    np.testing.assert_array_equal(time, fast)
    np.testing.assert_allclose(on_it["j.angle"][:9_980], fast[:9_980], atol=1e-12)
    assert "its noise shows too small there" in told[0].message


def test_means_between_times():
    time = np.array([0.0, 1.0, 2.0, 3.0, 4.0])
    values = np.array([1.0, 3.0, np.nan, 5.0, 7.0])
    np.testing.assert_array_equal(averaged(time, values, np.array([0.0, 2.0, 3.0, 5.0])), [2.0, np.nan, 6.0])


def test_a_command_that_is_published_on_change_is_known_everywhere():
    """What is held between bursts is averaged over time, not over samples."""
    bursts = np.concatenate([np.arange(10) * 0.01 + start for start in (0.0, 3.0, 6.0)])
    values = np.repeat([1.0, -2.0, 4.0], 10)
    edges = np.arange(0.0, 8.01, 0.02)
    found = averaged_held(bursts, values, edges)
    np.testing.assert_allclose(
        found, np.where(edges[:-1] < 2.999, 1.0, np.where(edges[:-1] < 5.999, -2.0, 4.0))
    )
    uneven = averaged_held(np.array([0.0, 0.9]), np.array([0.0, 10.0]), np.array([0.0, 1.0]))
    np.testing.assert_allclose(uneven, 1.0)
    assert np.isnan(averaged_held(np.array([0.5]), np.array([1.0]), np.array([0.0, 1.0]))).all()


def test_an_even_clock_s_means_are_those_of_its_samples():
    time, rng = np.arange(1000) * 1e-3, np.random.default_rng(1)
    values, edges = rng.normal(size=1000), np.arange(0.0, 1.0001, 0.01)
    np.testing.assert_allclose(averaged_held(time, values, edges), averaged(time, values, edges), atol=1e-9)
