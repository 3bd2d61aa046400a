"""A machine stepped onwards does what a rollout through the same commands does."""

import numpy as np
import pytest

from hydrolek_drake.errors import InputError
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.kernel import SIGNALS
from hydrolek_drake.rollout.onwards import onwards
from hydrolek_drake.rollout.together.together import JointsTogether

pytestmark = pytest.mark.xdist_group("joints together")

ROUNDING = 1e-9
"""Share of a signal's range: times are sums here and products there."""


def _stepped(rig: Rig, joints: tuple[str, ...], times: np.ndarray, volts: np.ndarray) -> np.ndarray:
    """Signals at all times. # (k, joints, 8)."""
    (machine,) = onwards(rig, joints, float(times[0]), {})
    found = [machine.signals.copy()]
    for held, until in zip(volts[:-1], times[1:], strict=True):
        machine.advance(held, float(until))
        found.append(machine.signals.copy())
    return np.array(found)


def _same(stepped: np.ndarray, rolled: np.ndarray) -> None:
    allowed = ROUNDING * np.maximum(np.ptp(rolled, axis=0), 1e-12)
    assert np.isfinite(rolled).all()
    assert (np.abs(stepped - rolled).max(axis=0) <= allowed).all()


@pytest.mark.parametrize("every", [0.01, 0.007, 0.0004], ids=["10 ms", "7 ms", "near the step"])
def test_a_joint_with_play_leak_dead_time_and_a_load_that_is_picked_up(every: float) -> None:
    rig = load_rig("joint_bench").with_values(
        {
            "command.delay": 0.0123,  # commands arrive within steps
            "effects.load.payload.mass_kg": 3.0,
            "effects.load.payload.time_s": 0.6,
            "effects.linkage.backlash.gap_rad": 0.004,
            "effects.valve.null_leakage.conductance_m3_per_s_Pa": 1e-13,
            "effects.sensor.hysteresis.half_width_rad": 0.003,
        }
    )
    times = 2.0 + every * np.arange(round(1.2 / every))
    levels = np.random.default_rng(3).uniform(-5.0, 5.0, 24)
    volts = levels[((times - 2.0) / 0.05).astype(int)]
    step, spool = rig.value("integration.longest_step"), int(rig.value("integration.spool_steps"))
    rolled = roll_out(rig.records(), times, volts, times, longest_step=step, spool_steps=spool).signals
    _same(
        _stepped(rig, rig.joints, times, volts[:, None])[:, 0],
        np.array([getattr(rolled, name) for name in SIGNALS]).T,
    )


def test_joints_of_one_arm_with_a_payload_that_is_picked_up(two_joints: Rig) -> None:
    rig = two_joints.with_values(
        {
            "joints.right_j2.effects.load.payload.mass_kg": 15.0,
            "joints.right_j2.effects.load.payload.time_s": 0.4,
            "joints.right_j3.effects.command.delay.delay_s": 0.011,
            "joints.right_j2.effects.supply.pressure_droop.resistance_Pa_s_per_m3": 3e10,
        }
    )
    times = 1.0 + 0.01 * np.arange(80)
    levels = np.random.default_rng(3).uniform(-3.0, 3.0, (8, 2))
    volts = np.repeat(levels, 10, axis=0)
    records = rig.records()
    places = records["load"]["initial_position"]
    rolled = JointsTogether(rig, rig.joints).roll_out(records, times, volts, times, places)
    assert rolled.diverged is None
    stepped = _stepped(rig, rig.joints, times, volts)
    _same(stepped, np.moveaxis(np.array([rolled.signals[name] for name in SIGNALS]), 0, 2))


def test_a_machine_that_leaves_all_bounds_says_so() -> None:
    rig = load_rig("joint_bench").with_values({"integration.longest_step": 0.05})
    (machine,) = onwards(rig, rig.joints, 0.0, {})
    with pytest.raises(InputError, match=r"joint: left all bounds at \d"):
        for k in range(40):
            machine.advance(np.array([8.0 * (-1.0) ** k]), 0.1 * (k + 1))
