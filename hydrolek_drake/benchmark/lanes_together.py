"""Machines whose joints all move together, in lanes beside one by one, in units of one rollout, in one run."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.benchmark.lanes import COLUMNS, COUNTS, SPREAD, LanesSpeed, median_seconds, varied
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.parameter_set import Free, ParameterSet
from hydrolek_drake.identification.problem_together import problem_of
from hydrolek_drake.identification.sensitivity.varied import varied_parameters
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.lanes.lanes import one_by_one
from hydrolek_drake.rollout.together.lanes import roll_out_together
from hydrolek_drake.rollout.together.together import JointsTogether


def measure_lanes_together(
    rig: Rig, times: np.ndarray, volts: np.ndarray, repeats: int, report: Callable[[str], None]
) -> list[LanesSpeed]:
    """Rows of the benchmark: all joints of a machine.

    Args:
        rig: the machine.
        times: of the commands [s]. # (n,)
        volts: held from then on. # (n, joints)
        repeats: runs of each; the median counts.
        report: told what is measured next.
    """
    label = f"{rig.name}, all {len(rig.joints)} joints"
    report(f"machines in lanes: {label}")
    generator, machine, own = np.random.default_rng(1), JointsTogether(rig, rig.joints), rig.records()
    places = own["load"]["initial_position"]
    runs = [machine.run(varied(own, generator), times, volts, times, places) for _ in range(max(COUNTS))]

    def in_lanes(count: int) -> Any:
        return roll_out_together(runs[:count], at_once=count > 1)

    def every(count: int) -> None:
        for run in runs[:count]:
            run.outcome()

    every(1)  # both are compiled before anything is measured
    in_lanes(2)
    one, rows = median_seconds(every, 1, repeats), []
    for count in COUNTS:
        used, scalar = median_seconds(in_lanes, count, repeats), median_seconds(every, count, repeats)
        rows.append(LanesSpeed(label, count, used / one, scalar / one, count * float(times[-1]) / used))
    return rows


def measure_jacobian_together(
    rig: Rig, times: np.ndarray, volts: np.ndarray, repeats: int, report: Callable[[str], None]
) -> LanesSpeed:
    """Jacobian of `COLUMNS` parameters of all joints, residuals and records included; arguments as above."""
    label = f"{rig.name}, all {len(rig.joints)} joints"
    report(f"Jacobian: {label}")
    places = rig.records()["load"]["initial_position"]
    run = JointsTogether(rig, rig.joints).run(rig.records(), times, volts, times, places)
    done = run.outcome()
    signals = {f"{joint}.command": volts[:, i] for i, joint in enumerate(rig.joints)}
    signals |= {f"{joint}.angle": done.signals["reading"][:, i] for i, joint in enumerate(rig.joints)}
    parameters = ParameterSet(rig, _some(rig))
    problem = problem_of(parameters, experiments_of(rig, Recording("made", times, signals, Path("made.csv"))))
    place = parameters.unit()
    base = problem.residuals(place)
    roll_out_together([run], at_once=True)
    used = median_seconds(lambda _: problem.jacobian(place, base), 1, repeats)
    rollout = median_seconds(lambda _: run.outcome(), 1, repeats)
    with one_by_one():
        scalar = median_seconds(lambda _: problem.jacobian(place, base), 1, repeats)
    return LanesSpeed(label, COLUMNS, used / rollout, scalar / rollout, COLUMNS * float(times[-1]) / used)


def _some(rig: Rig) -> tuple[Free, ...]:
    """`COLUMNS` parameters, drawn from those of all joints."""
    found = [
        free
        for joint in rig.joints
        for free in varied_parameters(rig, joint, SPREAD).free
        if f".{joint}." in free.path
    ]
    drawn = np.random.default_rng(1).choice(len(found), COLUMNS, replace=False)
    return tuple(found[i] for i in sorted(drawn.tolist()))
