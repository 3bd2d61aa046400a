"""A machine of the bench whose piston leaks more and more, by the challenge's own simulator."""

from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.challenge.build import build_of
from hydrolek_drake.challenge.cases import driven, with_concealed
from hydrolek_drake.challenge.drawing import SIZING_STEP_S
from hydrolek_drake.challenge.driving import SAMPLE_S
from hydrolek_drake.recordings import write_signals
from hydrolek_drake.rigs import load_rig

SECONDS = 14.0
GROWTH = 1.0e-13
"""Leakage that each later recording has more, from the third one [m^3/(s Pa)]."""

COUNT = 7
WARM = 0.15
"""Share by which friction and flow change as the oil of a machine warms up, far more than is needed to see it."""


def _record(path, build, machine, seed, seconds=SECONDS):
    rig, rng = build.rig, np.random.default_rng(seed)
    noise, resolution = rig.value("sensor.noise"), rig.value("sensor.resolution")
    done = driven(build, machine, "open", seconds, rng, noise, SIZING_STEP_S)
    reading = done.reading + noise * rng.standard_normal(done.reading.size)
    signals = {"joint.command": done.volts, "joint.angle": np.round(reading / resolution) * resolution}
    write_signals(
        path, np.arange(done.volts.size) * SAMPLE_S, signals, {"joint.command": "V", "joint.angle": "rad"}
    )


@pytest.fixture(scope="session")
def machine_days(tmp_path_factory) -> Path:
    """Folder with `reference_*.csv`, and folders `leaking`, `healthy` and `warm` with a recording a day."""
    folder = tmp_path_factory.mktemp("days")
    build = build_of(load_rig("joint_bench"))
    rng = np.random.default_rng(7)
    own = {f: build.rig.value(path) * float(rng.uniform(0.92, 1.08)) for f, path in build.spread.items()}
    machine = build.nominal._replace(**own)
    for name in ("leaking", "healthy", "warm"):
        (folder / name).mkdir()
    for number in range(3):
        _record(folder / f"reference_{number}.csv", build, machine, 10 + number)
    for day in range(COUNT):
        size = GROWTH * max(day - 1, 0)
        worn = with_concealed(machine, {"cylinder.cross_port_leakage": {"conductance_m3_per_s_Pa": size}})
        _record(folder / "leaking" / f"run_2026-03-{day + 1:02d}.csv", build, worn, 30 + day)
        if day < 4:
            _record(folder / "healthy" / f"run_2026-03-{day + 1:02d}.csv", build, machine, 50 + day)
    for number in range(3):
        warm = with_concealed(machine, {"fluid.warm_up": {"fraction": WARM, "time_constant_s": 11.7}})
        path = folder / "warm" / f"run_2026-03-{number + 1:02d}.csv"
        _record(path, build, warm, 70 + number, seconds=20.0)
    return folder


@pytest.fixture(scope="session")
def references(machine_days) -> list[Path]:
    return sorted(machine_days.glob("reference_*.csv"))


@pytest.fixture(scope="session")
def growth() -> float:
    return GROWTH


@pytest.fixture(scope="session")
def planted() -> list[float]:
    """Leakage of each recording [m^3/(s Pa)]."""
    return [GROWTH * max(day - 1, 0) for day in range(COUNT)]
