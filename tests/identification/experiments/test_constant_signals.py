"""Signals that never change: a dead gauge, a simulator's supply pressure, a sensor that is not connected."""

from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.errors import UninformativeError
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig


def _recorded(**changed):
    time = np.arange(0.0, 4.0, 0.01)
    noise = np.random.default_rng(1).normal(size=(3, time.size))
    signals = {
        "joint.command": 3.0 * np.sin(2.0 * time),
        "joint.angle": 0.3 + 0.1 * np.sin(time) + 1e-3 * noise[0],
        "joint.pressure_a": 5e6 + 1e6 * np.sin(time) + 1e4 * noise[1],
        "supply.pressure": 12e6 + 1e5 * np.sin(time) + 1e4 * noise[2],
    }
    return Recording("made", time, signals | changed, Path("made.csv"))


@pytest.mark.parametrize("key", ["joint.pressure_a", "supply.pressure"])
def test_a_constant_pressure_is_not_followed_and_the_others_are(key):
    rig = load_rig("joint_bench")
    usual, constant = _recorded(), _recorded(**{key: np.full(400, 5e6)})
    [with_all], [without] = experiments_of(rig, usual), experiments_of(rig, constant)
    assert {c.key for c in with_all.channels} - {c.key for c in without.channels} == {key}
    signals = without.simulate(rig.records()).signals
    assert np.isfinite(without.residuals(signals)).all()


def test_a_constant_position_tells_nothing():
    with pytest.raises(UninformativeError, match=r"joint\.angle is constant"):
        experiments_of(load_rig("joint_bench"), _recorded(**{"joint.angle": np.full(400, 0.3)}))
