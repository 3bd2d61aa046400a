"""A valve that is switched on and off, beside the straight ways of its spool."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.errors import InputError
from hydrolek_drake.physics.solenoid import advance
from hydrolek_drake.rollout import roll_out

STROKE, OPENING, CLOSING = 0.5e-3, 25e-3, 15e-3


def _spool(rig, times, volts):
    return roll_out(rig.records(), times, volts, times, longest_step=5e-4).signals.spool


def test_the_spool_opens_closes_and_crosses_the_middle_in_its_times(with_component):
    rig = with_component("switching_valve").with_values({"command.delay": 0.0})
    times = np.arange(0.0, 0.3, 1e-3)
    volts = np.select([times < 0.1, times < 0.2], [3.0, -8.0], 2.9)  # on, the other coil, off
    knots = [0.0, OPENING, 0.1, 0.1 + CLOSING, 0.1 + CLOSING + OPENING, 0.2, 0.2 + CLOSING, 0.3]
    places = [0.0, STROKE, STROKE, 0.0, -STROKE, -STROKE, 0.0, 0.0]
    assert_allclose(_spool(rig, times, volts), np.interp(times, knots, places), atol=1e-12)


def test_a_coil_below_its_threshold_moves_nothing_and_one_above_it_all(with_component):
    rig = with_component("switching_valve")
    times = np.arange(0.0, 0.3, 5e-3)
    assert not _spool(rig, times, np.full(times.size, 2.999)).any()
    assert_allclose(
        _spool(rig, times, np.full(times.size, 3.0)),
        _spool(rig, times, np.full(times.size, 10.0)),
        rtol=1e-15,
    )


@pytest.mark.parametrize("parts", [1, 2, 7, 40])
def test_the_way_does_not_depend_on_how_time_is_cut(with_component, parts):
    joint = with_component("switching_valve").records()[0]
    for begin in np.linspace(-STROKE, STROKE, 9):
        for drive in (-5.0, 0.0, 5.0):
            whole, _ = advance(begin, 0.0, max(drive, 0.0), max(-drive, 0.0), 32e-3, 1, joint)
            x = begin
            for _ in range(parts):
                x, _ = advance(x, 0.0, max(drive, 0.0), max(-drive, 0.0), 32e-3 / parts, 1, joint)
            assert_allclose(x, whole, atol=1e-15)


@pytest.mark.parametrize("duty", [0.3, 0.5, 0.8])
def test_pulses_open_the_valve_by_what_their_trapezium_covers(with_component, duty):
    """On for d T with T long enough to end: the mean opening is d + (closing - opening)/(2 T)."""
    rig, period = with_component("switching_valve").with_values({"command.delay": 0.0}), 0.2
    times = np.arange(0.0, 2.0, 1e-3)
    volts = np.where(np.mod(times + 1e-9, period) < duty * period, 5.0, 0.0)
    mean = _spool(rig, times, volts)[times >= 1.0 - 1e-9].mean() / STROKE
    assert mean == pytest.approx(duty + 0.5 * (CLOSING - OPENING) / period, abs=1e-3)


def test_a_longer_pulse_moves_the_joint_farther(with_component):
    rig = with_component("switching_valve")
    times = np.arange(0.0, 1.0, 5e-3)
    ends = []
    for length in (0.05, 0.1, 0.2):
        volts = np.where(times < length, 5.0, 0.0)
        position = roll_out(rig.records(), times, volts, times, longest_step=5e-4).signals.position
        ends.append(position[-1] - position[0])
    assert 0.0 < ends[0] < 0.7 * ends[1] < 0.49 * ends[2]


@pytest.mark.parametrize(
    ("name", "wrong", "says"),
    [
        ("switching_with_amplifier", {}, "has no amplifier"),
        ("switching_valve", {"solenoid.threshold": 12.0}, "never switch"),
    ],
)
def test_a_switching_valve_that_makes_no_sense_is_refused(with_component, name, wrong, says):
    with pytest.raises(InputError, match=says) as caught:
        with_component(name).with_values(wrong)
    assert "\n" not in str(caught.value)
