"""No controller drives the valve open on bad data."""

from dataclasses import replace

import numpy as np
import pytest

from hydrolek_drake.control.catalogue import CONTROLLERS, build_law, thesis_setting
from hydrolek_drake.control.models.sdp_model import thesis_model

SETTING = thesis_setting("j2")
MODEL = thesis_model("j2")


def _law(name, noisy=False):
    return build_law(name, SETTING, noisy=noisy)


def _follow(law, wanted, corrupt, samples, supply=lambda k: True, noise=None):
    """Closed loop on the model; `corrupt(k, angle)` is what the controller reads. Returns voltages, angles."""
    state, angle, held = law.initial(corrupt(0, 0.0)), 0.0, [0.0] * 15
    voltages, angles = [], []
    for k in range(samples):
        reading = corrupt(k, angle) + (0.0 if noise is None else float(noise.normal(0.0, 0.05)))
        state, _, voltage = law.step(state, wanted(k), reading)
        voltages.append(voltage)
        for _ in range(5):
            held.append(voltage)
            angle = MODEL.step(angle, held.pop(0)) if supply(k) else max(angle - 0.05, MODEL.lower_deg)
        angles.append(angle)
    return np.array(voltages), np.array(angles)


@pytest.mark.parametrize("name", CONTROLLERS)
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, 400.0, -200.0])
def test_a_lost_measurement_closes_the_valve_at_once_and_control_returns_with_it(name, bad):
    voltages, angles = _follow(_law(name), lambda k: 30.0, lambda k, y: bad if 5 <= k < 20 else y, 260)
    assert np.any(voltages[:5] != 0.0)
    assert np.all(voltages[5:20] == 0.0)
    assert np.any(voltages[20:] != 0.0)
    assert abs(angles[-1] - 30.0) < 12.0


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_withdrawn_set_point_closes_the_valve(name):
    voltages, _ = _follow(_law(name), lambda k: np.nan if k >= 5 else 30.0, lambda k, y: y, 40)
    assert np.all(voltages[5:] == 0.0)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_measurement_that_is_lost_from_the_start_never_opens_the_valve(name):
    voltages, _ = _follow(_law(name), lambda k: 30.0, lambda k, y: np.nan, 40)
    assert np.all(voltages == 0.0)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_stuck_reading_closes_the_valve_for_good_until_the_set_point_is_withdrawn(name):
    voltages, _ = _follow(_law(name), lambda k: 30.0, lambda k, y: min(y, 8.0), 300)
    driven = np.flatnonzero(np.abs(voltages) > 1.5 * 1.34)
    assert np.all(voltages[-40:] == 0.0) or len(driven) == 0 or np.all(np.abs(voltages[-40:]) <= 1.5 * 1.34)
    law = _law("pip_idz_b")
    voltages, _ = _follow(law, lambda k: 30.0, lambda k, y: min(y, 8.0), 300)
    assert np.all(voltages[-100:] == 0.0)
    voltages, _ = _follow(
        law, lambda k: np.nan if 200 <= k < 205 else 30.0, lambda k, y: min(y, 8.0) if k < 200 else y, 400
    )
    assert np.any(voltages[205:] != 0.0)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_a_frozen_reading_of_a_noisy_sensor_closes_the_valve(name):
    """The sensor dies while the joint moves: within 15 samples the valve is shut, and stays shut."""
    noise = np.random.default_rng(2)
    law, state = _law(name, noisy=True), None
    state = law.initial(0.0)
    for k in range(120):
        reading = 3.0 if k >= 20 else float(noise.normal(0.0, 0.05))
        state, _, voltage = law.step(state, 0.0 if k < 20 else 30.0, reading)
        if k >= 20 + 16:
            assert voltage == 0.0


@pytest.mark.parametrize("name", ["pi", "pid", "pip_scaled", "pip_idz_a", "pip_idz_b", "pip_forward_b"])
def test_with_the_supply_lost_the_valve_closes(name):
    """The joint sinks slowly, whatever is commanded."""
    voltages, _ = _follow(_law(name), lambda k: 40.0, lambda k, y: y, 400, supply=lambda k: k < 10)
    assert np.any(voltages[10:20] != 0.0)
    assert np.all(voltages[-100:] == 0.0)


@pytest.mark.parametrize("name", CONTROLLERS)
@pytest.mark.parametrize("wanted", [500.0, -500.0, 1e30])
def test_set_points_beyond_the_range_are_taken_as_its_end(name, wanted):
    far = _follow(_law(name), lambda k: wanted, lambda k, y: y, 100)
    end = MODEL.upper_deg if wanted > 0 else MODEL.lower_deg
    near = _follow(_law(name), lambda k: end, lambda k, y: y, 100)
    assert far[0] == pytest.approx(near[0])
    assert np.all(np.abs(far[0]) <= 10.0)


@pytest.mark.parametrize("name", CONTROLLERS)
def test_healthy_steps_are_never_taken_for_a_fault(name):
    law = _law(name, noisy=True)
    noise = np.random.default_rng(4)
    state, angle, held = law.initial(0.0), 0.0, [0.0] * 15
    for k in range(400):
        wanted = 30.0 if k < 200 else 0.0
        state, _, voltage = law.step(state, wanted, angle + float(noise.normal(0.0, 0.05)))
        assert not law.faulty(state)
        for _ in range(5):
            held.append(voltage)
            angle = MODEL.step(angle, held.pop(0))


@pytest.mark.parametrize("name", ["pi", "pip_scaled", "pip_idz_b"])
def test_saturation_does_not_wind_up_the_integral(name):
    """A far set point for a long time, then one behind the joint: the valve reverses sooner than without."""
    reversed_after = {True: 400}  # unless it happens sooner
    for thesis_form in (False, True):
        law = build_law(name, replace(SETTING, thesis_form=thesis_form), noisy=False).law
        state = law.initial(0.0)
        for k in range(100):
            state, _, voltage = law.step(state, 65.0, 0.3 * k)  # moving, but never there
        assert voltage > 1.0
        for k in range(400):
            state, _, voltage = law.step(state, 20.0, 30.0 - 0.02 * k)
            if voltage < 0.0:
                reversed_after[thesis_form] = k
                break
    assert reversed_after[False] < 0.7 * reversed_after[True]
