"""Short recordings of the bench, made by its own rollout."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig


@pytest.fixture(scope="session")
def bench() -> Rig:
    return load_rig("joint_bench", {})


@pytest.fixture(scope="session")
def recorded() -> Callable[..., list[Experiment]]:
    """(rig that plays the machine, rig that is fitted, seed, noise in deg) -> experiments of 12 s."""

    def make(machine: Rig, model: Rig, seed: int = 1, noise_deg: float = 0.05) -> list[Experiment]:
        rng = np.random.default_rng(seed)
        time = np.arange(0.0, 12.0, 0.01)
        levels = np.repeat(rng.uniform(-9.0, 9.0, 24), 50)
        levels[:50] = 0.0
        blank = Recording(
            "made",
            time,
            {"joint.command": levels, "joint.angle": rng.normal(0.4, 0.1, time.size)},
            Path("made.csv"),
        )
        played = experiments_of(machine, blank)[0].simulate(machine.records(), 1e-4).signals.reading
        angle = played + np.radians(noise_deg) * rng.standard_normal(time.size)
        made = Recording("made", time, {"joint.command": levels, "joint.angle": angle}, Path("made.csv"))
        return experiments_of(model, made)

    return make
