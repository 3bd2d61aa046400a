"""The rollout against the joint bench as a user would write it first, integrated by SciPy's LSODA."""

import numpy as np
import pytest

from hydrolek_drake.benchmark.measure import random_voltage
from hydrolek_drake.benchmark.plain_bench import simulate_plainly
from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out


@pytest.mark.parametrize(("step", "allowed_deg"), [(1e-5, 1e-4), (5e-4, 0.02)])
def test_the_rollout_agrees_with_an_independent_integration(step: float, allowed_deg: float) -> None:
    rig = load_rig("joint_bench", {})
    times, volts = random_voltage(2.0, 1, np.random.default_rng(3))
    command = np.ascontiguousarray(volts[:, 0])
    told = roll_out(rig.records(), times, command, times, longest_step=step).signals.position
    plain = simulate_plainly(rig, times, command)
    assert np.ptp(plain) > np.radians(5.0)
    assert np.degrees(np.abs(told - plain).max()) < allowed_deg
