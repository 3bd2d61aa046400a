"""Order of the integrator, and independence of the steps."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out


def test_integrator_is_of_second_order_on_a_smooth_motion(bench):
    # the joint moves and its spool is open from the start: no kink at overlap or stops
    values = {"command.delay": 0.0, "load.initial_position": np.radians(-5.0)}
    records = bench.with_values(values).records()
    changes = np.arange(-1.0, 1.0, 0.02)
    volts = 5.5 + 1.5 * np.sin(2 * np.pi * changes / 0.7)
    opened = roll_out(records, changes, volts, np.array([-1.0, 0.0]), longest_step=1e-4).state
    times = np.array([0.0, 0.3, 0.35])
    finals = {}
    steps = [2e-3, 1e-3, 5e-4, 2.5e-4, 2e-6]
    for step in steps:
        outcome = roll_out(records, changes, volts, times, state=opened, longest_step=step)
        finals[step] = outcome.signals
    reference = finals[steps[-1]]
    for name in ("position", "velocity", "pressure_a", "pressure_b", "spool"):
        errors = [abs(getattr(finals[s], name)[-1] - getattr(reference, name)[-1]) for s in steps[:-1]]
        slope = np.polyfit(np.log(steps[1:-1]), np.log(errors[1:]), 1)[0]
        print(f"{name}: slope {slope:.3f}, errors {errors}")
        assert_allclose(slope, 2.0, atol=0.25)


def _steps():
    changes = np.arange(0.0, 2.0, 0.05)
    return changes, 8.0 * np.sign(np.sin(9.0 * changes))


def test_results_change_smoothly_with_the_delay_whatever_the_step(bench):
    """Delays 0.05 ms apart at steps of 0.5 ms.

    If commands took effect at the next step only, the end would jump by speed times step, 0.02 deg. What is
    left is where in a step the spool crosses its overlap.
    """
    step = 5e-4
    delays = 0.02 + 5e-5 * np.arange(61)
    ends = []
    for delay in delays:
        records = bench.with_values({"command.delay": delay}).records()
        signals = roll_out(records, *_steps(), np.array([0.0, 1.93]), longest_step=step).signals
        ends.append(signals.position[-1])
    scaled = (delays - delays.mean()) / np.ptp(delays)
    ripple = np.array(ends) - np.polyval(np.polyfit(scaled, ends, 3), scaled)
    jump = abs(signals.velocity[-1]) * step
    print(f"ripple {np.degrees(np.abs(ripple).max()):.2e} deg, a jump would be {np.degrees(jump):.2e} deg")
    assert np.degrees(jump) > 0.02
    assert np.abs(ripple).max() < 0.05 * jump


def test_step_between_changes_of_the_command_hardly_matters(bench):
    records = bench.records()
    times = np.arange(0.0, 2.0, 0.0137)
    coarse, fine = (
        roll_out(records, *_steps(), times, longest_step=step).signals.position for step in (5e-4, 1e-5)
    )
    assert_allclose(coarse, fine, atol=np.radians(0.02))


@pytest.mark.parametrize(
    "effect",
    [
        {},
        {"amplifier.gain_fade": {"fraction": 0.3, "time_constant_s": 1.0}},
        {"fluid.warm_up": {"fraction": 0.3, "time_constant_s": 1.0}},
        {"sensor.drift": {"rate_rad_per_min": 0.5}},
        {"sensor.hysteresis": {"half_width_rad": 0.02}},
    ],
    ids=lambda effect: next(iter(effect), "none"),
)
def test_a_rollout_in_two_parts_is_the_rollout_in_one(bench, effect):
    """Also what warms up, drifts or plays goes on where it was."""
    values = {f"effects.{name}.{key}": v for name, own in effect.items() for key, v in own.items()}
    records = bench.with_values(values).records()
    times = np.arange(0.0, 2.0, 0.01)
    whole = roll_out(records, *_steps(), times, longest_step=5e-4)
    first = roll_out(records, *_steps(), times[:90], longest_step=5e-4)
    second = roll_out(records, *_steps(), times[89:], state=first.state, longest_step=5e-4)
    assert_allclose(second.signals.position, whole.signals.position[89:], rtol=1e-12)
    assert_allclose(second.signals.reading, whole.signals.reading[89:], rtol=1e-12)
    assert_allclose(second.state, whole.state, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_a_stiff_stop_bears_steps_that_are_longer_than_its_oscillation(exponent):
    """A link of some 100 kg struck against a stop of 1.5e8 N/m swings with far less than 4 ms."""
    rig = load_rig("hopsan_link").with_values(
        {
            "cylinder.stop_stiffness": 1.5e8,
            "cylinder.stop_damping": 1e3,
            "cylinder.stop_exponent": exponent,
            "cylinder.stop_dissipation": 1.0,
        }
    )
    limit = rig.value("command.limit")
    changes, volts = np.array([0.0, 4.0, 8.0]), np.array([limit, -limit, limit])
    times = np.arange(0.0, 11.0, 0.01)
    shown = {}
    for step in (4e-3, 1e-3, 1e-4):
        outcome = roll_out(rig.records(), changes, volts, times, longest_step=step)
        assert not outcome.diverged
        shown[step] = outcome.signals
    fine = shown[1e-4]
    struck = [np.flatnonzero(np.abs(fine.velocity[a:b]) > 1e-3)[-1] + a for a, b in ((0, 400), (400, 800))]
    assert struck[0] < 390 and struck[1] < 790  # both ends were reached, and it came to rest there
    noise = rig.value("sensor.noise")
    for step in (4e-3, 1e-3):
        rest = [abs(shown[step].position[i] - fine.position[i]) for i in (395, 795)]
        assert max(rest) < 0.1 * noise  # where it rests is a balance of forces, whatever the step
        farther = np.ptp(shown[step].position) - np.ptp(fine.position)
        within_a_step = step * np.abs(fine.velocity).max()  # it is struck at any moment of one
        assert farther < (noise if step == 1e-3 else within_a_step)  # no step flies through the stop
