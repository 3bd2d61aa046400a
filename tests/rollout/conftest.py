"""Rollouts of built-in rigs with other values, and of two joints on one pump."""

import numpy as np
import pytest

from hydrolek_drake.rigs import Rig, load_rig
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


@pytest.fixture(scope="session")
def on_a_pump(tmp_path_factory: pytest.TempPathFactory) -> Rig:
    """The right arm with two joints that move, which can draw more than their pump gives."""
    path = tmp_path_factory.mktemp("rig") / "on_a_pump.yaml"
    path.write_text(
        """
schema: 1
name: on_a_pump
based_on: hydrolek
keep: [right_j2, right_j3]
title: two joints on one pump
source: "chosen: a pump that the arm can draw empty"
supply:
  variant: pump
  pressure: {value: 16, unit: MPa}
  tank_pressure: {value: 0.2, unit: MPa}
  displacement: {value: 8, unit: cm^3/rev}
  speed: {value: 1500, unit: rpm}
  relief_slope: {value: 5e+9, unit: Pa s/m^3}
  relief_hysteresis: {value: 4, unit: bar}
  line_volume: {value: 1, unit: l}
"""
    )
    return load_rig(path, {})
