"""Units to be run: the bench as this package exports it, and those of a stranger, made from a few lines."""

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.rigs import Rig, load_rig

_STRANGER = """
import math, os, time
from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

class {name}(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.voltage, self.stroke_mm, self.bar, self.gain = 0.0, 100.0, 50.0, 20.0
        self.register_variable(Real("voltage", causality=Fmi2Causality.input))
        self.register_variable(Real("stroke_mm", causality=Fmi2Causality.output))
        self.register_variable(Real("bar", causality=Fmi2Causality.output))
        self.register_variable(
            Real("gain", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed)
        )

    def do_step(self, current_time, step_size):
        if current_time > 0.05:
            {does}
        self.stroke_mm += self.gain * self.voltage * step_size
        return True
"""


@pytest.fixture(scope="session")
def enlarged() -> Rig:
    """The bench as a diagnosis leaves it: a leak, play, a payload that is picked up, and longer dead time."""
    return load_rig("joint_bench").with_values(
        {
            "effects.valve.null_leakage.conductance_m3_per_s_Pa": 1e-13,
            "effects.linkage.backlash.gap_rad": 0.004,
            "effects.load.payload.mass_kg": 3.0,
            "effects.load.payload.time_s": 0.6,
            "effects.command.delay.delay_s": 0.0123,
        }
    )


@pytest.fixture(scope="session")
def volts() -> np.ndarray:
    """Voltages, one each 10 ms, for 3 s."""
    levels = np.random.default_rng(3).uniform(-5.0, 5.0, 12)
    return np.repeat(levels, 25)


@pytest.fixture(scope="session")
def exported(enlarged: Rig, tmp_path_factory: pytest.TempPathFactory) -> Callable[[int], Path]:
    """Version of FMI -> the enlarged bench as a unit."""
    pytest.importorskip("fmpy", reason="needs the extra fmu")
    from hydrolek_drake.fmu.exporting import export

    folder = tmp_path_factory.mktemp("exported")
    return lambda version: export(
        enlarged, enlarged.joints, folder / f"bench_{version}.fmu", version, 0.01, 3.0
    )


@pytest.fixture(scope="session")
def stranger(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """(name, what it does after 50 ms) -> a unit of a cylinder that is told in mm and bar."""
    pytest.importorskip("fmpy", reason="needs the extra fmu")
    pythonfmu = pytest.importorskip("pythonfmu", reason="needs the extra fmu")

    def make(name: str, does: str = "pass") -> Path:
        folder = tmp_path_factory.mktemp(name)
        script = folder / f"{name}.py"
        script.write_text(_STRANGER.format(name=name, does=does))
        before = list(sys.path)
        try:
            return Path(pythonfmu.FmuBuilder.build_FMU(script, dest=folder))
        finally:
            sys.path[:] = before
            sys.modules.pop(name, None)

    return make
