"""Short recordings of the bench, made by its own rollout, and what is found in them."""

import math
from collections.abc import Callable, Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.inquiry import Answer, Inquiry
from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import free_parameters
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


@pytest.fixture(scope="session")
def fitted() -> Callable[..., Hypothesis]:
    """(workbench, additions, where they begin, steps, step over the rig's own) -> a structure, fitted."""

    def fit(
        workbench: Workbench, effects=(), values=None, rounds: int = 12, coarse: float = 1.0
    ) -> Hypothesis:
        rung = Rung(math.inf, coarse, math.inf, rounds, 1)
        return race(workbench, [Entrant(tuple(effects), values or {})], (rung,))[0]

    return fit


SHIFTED = {"valve.max_area": 1.08, "fluid.bulk_modulus": 0.9, "supply.pressure": 1.05}
"""By how much the machine's own numbers differ from the rig's."""


@pytest.fixture(scope="session")
def answer_of(bench, recorded) -> Callable[..., Answer]:
    """(planted values, effects that are candidates, laws too, own numbers, told, how it was recorded, training)
    -> the answer for a machine with other numbers than the rig."""

    def make(
        planted: dict[str, float],
        only: Collection[str] | None = None,
        laws: bool = True,
        own: dict[str, float] = SHIFTED,
        say: Callable[[str], None] = lambda text: None,
        trained: dict | None = None,
        **how,
    ) -> Answer:
        free = [each.path for each in free_parameters(bench)]
        numbers = {
            path: by * bench.value(path) for end, by in own.items() for path in free if path.endswith(end)
        }
        machine = bench.with_values({**numbers, **planted})
        how = {"pressure_noise_Pa": 3e4, **how}
        training = recorded(machine, bench, seed=1, **{**how, **(trained or {})})
        held_out = recorded(machine, bench, seed=2, **how)
        scales = natural_scales(bench, "joint", training)
        candidates = [c for c in candidates_of(bench, "joint", scales) if only is None or c.id in only]
        with ThreadPoolExecutor(2) as pool:
            workbench = Workbench(bench, free_parameters(bench), training, pool, 2)
            asked = Inquiry(candidates, {"joint": scales} if laws else {}, apart=True, say=say)
            return asked.answer(workbench, held_out)

    return make
