"""Machines with one component each."""

import numpy as np
import pytest
from component_machines import machine_text

from hydrolek_drake.rigs import load_rig


@pytest.fixture(scope="session")
def with_component(tmp_path_factory):
    """A function: component's name -> the rig that has it."""
    folder = tmp_path_factory.mktemp("machines")

    def make(name: str):
        path = folder / f"{name}.yaml"
        path.write_text(machine_text(name))
        return load_rig(path)

    return make


@pytest.fixture
def random_volts():
    """A function: seconds -> times and voltages that jump within +-6 V."""

    def make(seconds: float, seed: int = 4):
        times = np.arange(0.0, seconds, 0.01)
        levels = np.random.default_rng(seed).uniform(-6.0, 6.0, times.size // 30 + 1)
        return times, np.repeat(levels, 30)[: times.size]

    return make
