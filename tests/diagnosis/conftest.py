"""Short recordings of the bench, made by its own rollout, and laws that are sought in them."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis import law_scan, law_search, unlisted
from hydrolek_drake.diagnosis.baseline import fit_baseline
from hydrolek_drake.diagnosis.effort import POLISH
from hydrolek_drake.diagnosis.judged import Judged
from hydrolek_drake.diagnosis.law_problem import FoundLaw
from hydrolek_drake.diagnosis.unlisted import find_law
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.natural_scales import natural_scales
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.identification.recorded import experiments_of
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig


@pytest.fixture(scope="session")
def bench() -> Rig:
    return load_rig("joint_bench", {})


@pytest.fixture(scope="session")
def recorded() -> Callable[..., list[Experiment]]:
    """(machine, fitted rig, seed, noise, largest volts, pressures, unknown input, frequency, law, lost commands)
    -> 12 s of it."""

    def make(
        machine: Rig,
        model: Rig,
        seed: int = 1,
        noise_deg: float = 0.05,
        largest_V: float = 9.0,
        pressure_noise_Pa: float | None = None,
        unknown: tuple[str, float] | None = None,
        unknown_Hz: float = 0.0,
        law: Callable[[Experiment], np.ndarray] | None = None,
        lost_s: Sequence[tuple[float, float]] = (),
    ) -> list[Experiment]:
        rng = np.random.default_rng(seed)
        time = np.arange(0.0, 12.0, 0.01)
        levels = np.repeat(rng.uniform(-largest_V, largest_V, 24), 50)
        levels[:50] = 0.0
        blank = Recording(
            "made",
            time,
            {"joint.command": levels, "joint.angle": rng.normal(0.4, 0.1, time.size)},
            Path("made.csv"),
        )
        probes = None
        if unknown is not None:
            rows = np.zeros((time.size + 1, len(PROBES)))
            moments = 0.01 * np.arange(time.size + 1)
            course = np.sin(2.0 * np.pi * unknown_Hz * moments) if unknown_Hz > 0.0 else 1.0
            rows[:, PROBES.index(unknown[0])] = unknown[1] * course
            probes = (0.01, rows)
        experiment = experiments_of(machine, blank)[0]
        arrived = experiment.without_command(np.array(lost_s).reshape(-1, 2), 0.0)
        played = arrived.simulate(
            machine.records(), 1e-4, probes, law=None if law is None else law(experiment)
        ).signals
        angle = played.reading + np.radians(noise_deg) * rng.standard_normal(time.size)
        signals = {"joint.command": levels, "joint.angle": angle}
        if pressure_noise_Pa is not None:
            for side in ("pressure_a", "pressure_b"):
                noise = pressure_noise_Pa * rng.standard_normal(time.size)
                signals[f"joint.{side}"] = getattr(played, side) + noise
        return experiments_of(model, Recording("made", time, signals, Path("made.csv")))

    return make


@pytest.fixture
def in_less_time(monkeypatch) -> None:
    """For laws that are not periodic: up to 4 Hz with free rollouts alone, at seven of eleven inputs."""
    own = unlisted.inputs_of
    left_out = ("command", "amplifier", "back_a", "back_b")
    monkeypatch.setattr(law_scan, "HIGHEST_HZ", 4.0)
    monkeypatch.setattr(law_search, "shaking", lambda *given: [])
    monkeypatch.setattr(
        unlisted, "inputs_of", lambda *given: tuple(i for i in own(*given) if i.probe not in left_out)
    )


@pytest.fixture
def with_fewer_laws(monkeypatch) -> None:
    """Half as many first fits, where what is right promises much."""
    monkeypatch.setattr(unlisted, "TRIED", 12)


@pytest.fixture
def sought() -> Callable[..., tuple[Workbench, Judged, FoundLaw | None]]:
    """(bench, training, held-out data) -> workbench, fitted nominal model, the law that is found beside it."""

    def seek(bench, training, held_out):
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool)
            nominal = workbench.refit(fit_baseline(workbench), workbench.fine, POLISH)
            left = workbench.residuals(nominal, held_out, workbench.fine)
            judged = Judged(nominal, left, sum(e.counted for e in held_out))
            scales = natural_scales(bench, "joint", training)
            return workbench, judged, find_law(workbench, judged, held_out, scales)

    return seek
