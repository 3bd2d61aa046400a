"""Rollouts of built-in rigs with other values."""

import numpy as np
import pytest

from hydrolek_drake.rigs import load_rig
from hydrolek_drake.rollout import roll_out


@pytest.fixture(scope="session")
def bench():
    """The rig joint_bench."""
    return load_rig("joint_bench")


@pytest.fixture(scope="session")
def slide():
    """A cylinder that moves a slide directly, so that its lever is constant."""
    return load_rig("festo_tp511")


@pytest.fixture(scope="session")
def run():
    """A function: rig, its values by path (SI), a held voltage or (times, volts), times -> Outcome."""

    def roll(rig, values, command, times, *, longest_step=1e-4, state=None):
        if np.isscalar(command):
            command = (np.array([times[0] - 1.0]), np.array([command], dtype=float))
        records = rig.with_values(values).records()
        return roll_out(records, *command, times, longest_step=longest_step, state=state)

    return roll
