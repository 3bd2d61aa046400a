"""Diagnoses as they end, made without a search: the planted effects are named at their true sizes."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.evidence.judged import Conclusion, Judged
from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of
from hydrolek_drake.diagnosis.fitting.tried import Tried
from hydrolek_drake.diagnosis.intervals.curvature import Interval
from hydrolek_drake.diagnosis.locating.place import Location
from hydrolek_drake.diagnosis.structures.candidates import candidates_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.natural_scales import natural_scales
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import free_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import load_rig

DEVIATION = 0.02
"""Of each number, as a share of it."""


@pytest.fixture(scope="session")
def named() -> Callable[..., Diagnosis]:
    """(rig, planted sizes by id and parameter, seconds, seed) -> the diagnosis that names them.

    With nothing planted its verdict is that nothing is missing.
    """

    def make(
        rig_name: str, planted: dict[str, dict[str, float]], seconds: float = 6.0, seed: int = 3
    ) -> Diagnosis:
        rig = load_rig(rig_name, {})
        joint = rig.joints[0]
        values = {
            f"joints.{joint}.effects.{effect}.{name}": value
            for effect, own in planted.items()
            for name, value in own.items()
        }
        machine = rig.with_values(values)
        training, held_out = (
            (_recorded(machine, rig, joint, seconds, number),) for number in (seed, seed + 1)
        )
        bench = Workbench(rig, free_parameters(rig), training, ThreadPoolExecutor(1))
        every = candidates_of(rig, joint, natural_scales(rig, joint, training))
        effects = tuple(c for effect in planted for c in every if c.id == effect)

        def judged(some: tuple, own: dict[str, float]) -> Judged:
            problem = bench.problem(some, bench.fine)
            unit = problem.parameters.unit(own)
            place = Place(problem, np.ones(unit.size, dtype=bool), unit, problem.residuals(unit))
            hypothesis = hypothesis_of(some, place, bench.fine)
            left = bench.residuals(hypothesis, held_out, bench.fine)
            return Judged(
                hypothesis, left, sum(e.counted for e in held_out), probability=float(some == effects)
            )

        nominal = judged((), {})
        best = judged(effects, values) if effects else nominal
        places = tuple(Location(c.stage, joint, 0.9, ((1.0, 2.0),), "at low speed") for c in effects)
        return Diagnosis(
            rig=rig,
            verdict="missing_physics" if effects else "none",
            reasons=(),
            conclusion=Conclusion(
                "missing_physics" if effects else "none",
                best,
                dict.fromkeys((c.size_path for c in effects), 1.0),
                (),
            ),
            search=Tried(hypotheses={j.hypothesis.ids: j.hypothesis for j in (nominal, best)}),
            judged=(best, nominal) if effects else (nominal,),
            also_tried=(),
            bench=bench,
            held_out=held_out,
            locations=places,
            intervals={
                path: Interval(value, value - DEVIATION * abs(value), value + DEVIATION * abs(value))
                for path, value in best.hypothesis.values.items()
            },
            law=None,
            proposal=None,
            visible=(),
            seconds=1.0,
        )

    return make


def _recorded(machine, rig, joint: str, seconds: float, seed: int):
    """Random steps of half a second, and what a machine's joint does under them."""
    random = np.random.default_rng(seed)
    time = np.arange(0.0, seconds, 0.01)
    limit = 0.6 * machine.value(f"joints.{joint}.command.limit")
    volts = np.repeat(random.uniform(-limit, limit, round(2 * seconds) + 1), 50)[: time.size]
    volts[:50] = 0.0
    start = machine.value(f"joints.{joint}.load.initial_position")
    where = f"{joint}.{'position' if rig.variant(joint, 'load') == 'sliding' else 'angle'}"
    signals = {f"{joint}.command": volts, where: start + random.normal(0.0, 0.1, time.size)}
    blank = Recording("made", time, signals, Path("made.csv"))
    reading = experiments_of(machine, blank)[0].simulate(machine.records()).signals.reading
    noisy = reading + np.radians(0.05) * random.standard_normal(time.size)
    signals = {f"{joint}.command": volts, where: noisy}
    return experiments_of(rig, Recording(f"made {seed}", time, signals, Path("made.csv")))[0]
