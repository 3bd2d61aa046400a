"""Many machines in lanes beside the same machines one by one, in units of one rollout, in one run."""

import statistics
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.sensitivity.varied import varied_parameters
from hydrolek_drake.physics.records import flat, position_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig, load_rig
from hydrolek_drake.rollout import roll_out
from hydrolek_drake.rollout.lanes.lanes import one_by_one, roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
from hydrolek_drake.rollout.run import Run

COUNTS = (1, 8, 20, 64)
"""Machines: one, a table of lanes, a Jacobian of twenty parameters, a population."""

RUBBING = {
    "cylinder.coulomb_friction.coulomb_N": 0.03,
    "valve.spool_stiction.force_N": 0.02,
    "linkage.backlash.gap_rad": 0.002,
}
"""Effects of the second machine: shares of the largest oil force and of the solenoid's, and radians."""

COLUMNS = 20
"""Parameters of the Jacobians."""

SPREAD = 0.02
"""By which the machines' numbers differ."""


@dataclass(frozen=True)
class LanesSpeed:
    """How long some machines take.

    Attributes:
        machine: which.
        count: how many of them.
        in_lanes: processor time of all over that of one rollout; median.
        one_by_one: the same, one after the other.
        machine_seconds: simulated seconds of all of them per second in lanes.
    """

    machine: str
    count: int
    in_lanes: float
    one_by_one: float
    machine_seconds: float


def measure_lanes(
    times: np.ndarray, volts: np.ndarray, repeats: int, report: Callable[[str], None]
) -> list[LanesSpeed]:
    """Rows of the benchmark: the bench without effects, and an arm joint that rubs, sticks and plays.

    Args:
        times: of the command [s]. # (n,)
        volts: held from then on. # (n,)
        repeats: runs of each; the median counts.
        report: told what is measured next.
    """
    rows = []
    for label, rig in _machines():
        report(f"machines in lanes: {label}")
        records = varied(np.repeat(rig.records()[:1], max(COUNTS)), np.random.default_rng(1))
        step = rig.value("integration.longest_step")
        spool_steps = round(rig.value("integration.spool_steps"))

        def alone(
            i: int, records: np.ndarray = records, step: float = step, spool_steps: int = spool_steps
        ) -> Any:
            record = records[i : i + 1]
            return roll_out(record, times, volts, times, longest_step=step, spool_steps=spool_steps)

        def together(
            count: int, records: np.ndarray = records, step: float = step, spool_steps: int = spool_steps
        ) -> Any:
            run = Run(records[:1], times, volts, times, step, spool_steps)
            return roll_out_lanes(run.of(records[:count]), at_once=True)

        def every(count: int, alone: Callable[[int], Any] = alone) -> None:
            for i in range(count):
                alone(i)

        alone(0)  # both are compiled before anything is measured
        together(1)
        one = median_seconds(every, 1, repeats)
        for count in COUNTS:
            used, scalar = median_seconds(together, count, repeats), median_seconds(every, count, repeats)
            rows.append(LanesSpeed(label, count, used / one, scalar / one, count * float(times[-1]) / used))
    return rows


def measure_jacobians(
    times: np.ndarray, volts: np.ndarray, repeats: int, report: Callable[[str], None]
) -> list[LanesSpeed]:
    """Jacobians of `COLUMNS` parameters of the same two machines, residuals and records included.

    Args:
        times: as of `measure_lanes`.
        volts: as of `measure_lanes`.
        repeats: as of `measure_lanes`.
        report: as of `measure_lanes`.
    """
    rows = []
    for label, rig in _machines():
        report(f"Jacobian: {label}")
        record, step, joint = rig.records()[:1], rig.value("integration.longest_step"), rig.joints[0]
        spool_steps = round(rig.value("integration.spool_steps"))
        done = roll_out(record, times, volts, times, longest_step=step, spool_steps=spool_steps)
        reading = done.signals.reading
        signals = {f"{joint}.command": volts, f"{joint}.angle": reading}
        recording = Recording("made", times, signals, Path("made.csv"))
        free = varied_parameters(rig, joint, SPREAD).free[:COLUMNS]
        parameters = ParameterSet(rig, free)
        problem = Problem(parameters, experiments_of(rig, recording))
        place = parameters.unit()
        base = problem.residuals(place)

        def one(
            _: int, record: np.ndarray = record, step: float = step, spool_steps: int = spool_steps
        ) -> None:
            roll_out(record, times, volts, times, longest_step=step, spool_steps=spool_steps)

        def whole(
            _: int, problem: Problem = problem, at: np.ndarray = place, base: np.ndarray = base
        ) -> None:
            problem.jacobian(at, base)

        roll_out_lanes(Run(record, times, volts, times, step).of(np.repeat(record, LANES)), at_once=True)
        used, rollout = median_seconds(whole, 1, repeats), median_seconds(one, 1, repeats)
        with one_by_one():
            scalar = median_seconds(whole, 1, repeats)
        seconds = len(free) * float(times[-1]) / used
        rows.append(LanesSpeed(label, len(free), used / rollout, scalar / rollout, seconds))
    return rows


def _machines() -> list[tuple[str, Rig]]:
    return [
        ("joint_bench", load_rig("joint_bench")),
        (
            "hydrolek_right_j2 with Coulomb friction, sticking spool and play",
            rubbing(load_rig("hydrolek_right_j2")),
        ),
    ]


def rubbing(rig: Rig) -> Rig:
    """The rig with `RUBBING`."""
    record = rig.records()[0]
    scales: Mapping[str, float] = {
        "coulomb_N": float(record["cylinder"]["area_a"] * record["supply"]["pressure"]),
        "force_N": float(record["solenoid"]["spring"] * record["valve"]["full_opening_a"]),
        "gap_rad": 1.0,
    }
    where = f"joints.{rig.joints[0]}.effects"
    return rig.with_values(
        {f"{where}.{name}": share * scales[name.rpartition(".")[2]] for name, share in RUBBING.items()}
    )


def varied(records: np.ndarray, generator: np.random.Generator) -> np.ndarray:
    """Records with numbers that differ, delays among them."""
    found = records.copy()
    for name in ("supply.pressure", "fluid.bulk_modulus", "command.delay", "load.inertia", "valve.discharge"):
        factors = generator.uniform(1.0 - SPREAD, 1.0 + SPREAD, size=len(found))
        flat(found)[:, position_of(*name.split("."))] *= factors
    return found


def median_seconds(work: Callable[[int], Any], count: int, repeats: int) -> float:
    """Processor time of a piece of work."""
    taken = []
    for _ in range(repeats):
        begin = time.process_time()
        work(count)
        taken.append(time.process_time() - begin)
    return statistics.median(taken)
