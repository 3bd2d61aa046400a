"""Fitting a rig to recordings: parameters, objective, search, and what the result is worth."""

import contextlib
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.choices import METHODS, PLANTS
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.identification.fit.by_least_squares import by_least_squares
from hydrolek_drake.identification.fit.rig_objective import RigObjective
from hydrolek_drake.identification.identifiability import Identifiability, identifiability
from hydrolek_drake.identification.parameter_set import Free, ParameterSet, free_of_joints, free_parameters
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_on_diagram import ProblemOnDiagram
from hydrolek_drake.identification.problem_together import problem_of
from hydrolek_drake.identification.search.cluster import ClusterWorkers
from hydrolek_drake.identification.search.evaluation import Mapping
from hydrolek_drake.identification.search.genetic.settings import GeneticSettings
from hydrolek_drake.identification.search.journal import Journal
from hydrolek_drake.identification.search.search import SearchResult, search
from hydrolek_drake.identification.search.workers import ProcessWorkers, ThreadWorkers
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.readings import driven_joints
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.pool import RolloutPool

CONFIDENCE = 1.96
"""Standard errors on either side that hold 95 % of a normal distribution."""

SIGNALS = ("position", "pressure_a", "pressure_b", "supply_pressure", "current")
"""What is followed where it was recorded; the last in rigs of one joint, as of `experiments_of`."""


@dataclass(frozen=True)
class RigFit:
    """A fitted rig.

    Attributes:
        method: how it was found.
        rig: with the fitted values.
        parameters: what was searched.
        unit: solution in the unit cube. # (n,)
        over_noise: rms of the residuals over the noise; 1 for a perfect model.
        holdout_over_noise: the same on held-out recordings; None without.
        known: standard errors, correlations and blurred directions at the solution.
        evaluations: simulations of all recordings that it took.
        search: the search's course; None for least squares.
        interrupted: whether Ctrl-C ended it early.
    """

    method: str
    rig: Rig
    parameters: ParameterSet
    unit: np.ndarray
    over_noise: float
    holdout_over_noise: float | None
    known: Identifiability
    evaluations: int
    search: SearchResult | None
    interrupted: bool

    def intervals(self) -> dict[str, tuple[float, float, float]]:
        """Full path -> value and 95 % interval, cut at the range (SI).

        The standard errors are scaled by the misfit where that exceeds the noise.
        """
        half = CONFIDENCE * max(self.over_noise, 1.0) * self.known.deviation
        rows = {}
        for free, u, h in zip(self.parameters.free, self.unit, half, strict=True):
            low, high = np.clip([u - h, u + h], 0.0, 1.0)
            rows[free.path] = (
                free.from_unit(float(u)),
                free.from_unit(float(low)),
                free.from_unit(float(high)),
            )
        return rows


def searched(rig: Rig, recordings: Sequence[Recording], paths: Sequence[str] | None) -> tuple[Free, ...]:
    """Parameters that are fitted: those named, or all with a range but for those of joints that were not driven.

    Args:
        rig: the machine.
        recordings: that are to be fitted.
        paths: full or short paths; None if none are named.

    Raises:
        InputError: no such parameter, or one without a range.
    """
    if paths is not None:
        return free_parameters(rig, paths)
    return free_of_joints(rig, {joint for recording in recordings for joint in driven_joints(rig, recording)})


def fit_rig(
    rig: Rig,
    recordings: Sequence[Recording],
    method: str = "least-squares",
    *,
    paths: Sequence[str] | None = None,
    holdout: Sequence[Recording] = (),
    signals: tuple[str, ...] = SIGNALS,
    budget: int = 8000,
    p: float = 2.0,
    segments: int = 8,
    settings: GeneticSettings | None = None,
    loss: str = "linear",
    plant: str = "rollout",
    seed: int = 1,
    workers: int = 1,
    cluster: str | None = None,
    overdue: float | None = None,
    checkpoint: Path | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> RigFit:
    """Estimate parameters of a rig.

    Args:
        rig: start values, ranges and scales (linear or logarithmic).
        recordings: fitted together, each signal in units of its noise.
        method: one of `METHODS`.
        paths: which parameters; None for all with a range that the recordings can tell, see `searched`.
        holdout: recordings that are only compared with.
        signals: which of `SIGNALS` are followed.
        budget: simulations that a search may make.
        p: norm of the objective; least squares is p = 2.
        segments: of nsga2.
        settings: of the genetic algorithms; None for the thesis's.
        loss: of the least squares.
        plant: one of `PLANTS`: the compiled rollout, or the Drake Diagram; on that least squares is a search with a
            budget like the others.
        seed: of everything random.
        workers: threads; processes where an evaluation may be overdue, or runs on the Diagram.
        cluster: address of a Dask scheduler, instead of processes.
        overdue: time that one evaluation may take [s].
        checkpoint: file to which evaluations are written and from which an interrupted search goes on. Least
            squares takes seconds and keeps none.
        progress: told how many evaluations are done, and the best value.

    Raises:
        InputError: unknown method, parameter without range, recording without what is needed, no cluster.
    """
    if method not in METHODS:
        raise InputError(f"--method {method}: unknown; choose {', '.join(METHODS)}")
    parameters = ParameterSet(rig, searched(rig, recordings, paths))
    training = [one for recording in recordings for one in experiments_of(rig, recording, signals)]
    held = [one for recording in holdout for one in experiments_of(rig, recording, signals)]
    if plant not in PLANTS:
        raise InputError(f"--plant {plant}: unknown; choose {', '.join(PLANTS)}")
    on_diagram = plant == "diagram"
    problem = ProblemOnDiagram(parameters, training) if on_diagram else problem_of(parameters, training)
    by_rollouts = method == "least-squares" and not on_diagram
    if by_rollouts and (cluster is not None or overdue is not None):
        option = "--cluster" if cluster is not None else "--overdue"
        raise InputError(
            f"{option}: least-squares runs in threads of this process (--workers N) and cannot use it; "
            f"choose --method {', '.join(name for name in METHODS if name != method)}"
        )
    rng = np.random.default_rng(seed)
    if by_rollouts:
        with RolloutPool(workers) as threads:
            pool = threads if workers > 1 else None
            fit, evaluations, interrupted = by_least_squares(
                parameters, training, pool, workers, rng, loss, progress
            )
            jacobian = fit.jacobian
        unit, found = fit.unit, None
    else:
        objective = RigObjective(problem, p, segments if method == "nsga2" else None)
        journal = None
        if checkpoint is not None:
            size = objective.size
            journal = Journal(
                checkpoint,
                _belongs(rig, problem, method, seed, p, segments, settings, plant),
                len(parameters),
                size,
            )
        ends = np.zeros(len(parameters)), np.ones(len(parameters))
        with _workers(objective, workers, cluster, overdue) as evaluate:
            found = search(
                method,
                objective,
                *ends,
                budget,
                rng,
                settings=settings,
                loss=loss,
                first=parameters.unit()[None],
                evaluate=evaluate,
                journal=journal,
                progress=progress,
            )
        if journal is not None:
            journal.close()
        unit, evaluations, interrupted = found.point, found.evaluations, found.interrupted
        jacobian = problem.jacobian(unit)
    residuals = problem.residuals(unit)
    judge = None
    if held:
        judge = ProblemOnDiagram(parameters, held) if on_diagram else problem_of(parameters, held)
    return RigFit(
        method=method,
        rig=parameters.with_rig_values(unit),
        parameters=parameters,
        unit=unit,
        over_noise=_over_noise(residuals, problem),
        holdout_over_noise=None if judge is None else _over_noise(judge.residuals(unit), judge),
        known=identifiability(parameters.paths, jacobian),
        evaluations=evaluations,
        search=found,
        interrupted=interrupted,
    )


def _over_noise(residuals: np.ndarray, problem: Problem) -> float:
    return float(np.sqrt(residuals @ residuals / max(problem.counted, 1)))


@contextlib.contextmanager
def _workers(objective: RigObjective, workers: int, cluster: str | None, overdue: float | None) -> Any:
    """What evaluates several points: threads, processes, a cluster, or None for this thread."""
    if cluster is not None:
        with ClusterWorkers(objective, cluster, overdue) as over_cluster:
            yield over_cluster
    elif overdue is None and objective.batch > 1 and workers > 1:  # rollouts run outside Python's lock
        with ThreadWorkers(objective, workers) as over_threads:
            yield over_threads
    elif workers != 1 or overdue is not None:
        with ProcessWorkers(objective, workers, overdue) as over_processes:
            yield over_processes
    else:
        here: Mapping | None = None
        yield here


def _belongs(
    rig: Rig,
    problem: Problem,
    method: str,
    seed: int,
    p: float,
    segments: int,
    settings: GeneticSettings | None,
    plant: str,
) -> dict[str, Any]:
    """What a checkpoint is bound to: the same search on the same data."""
    data = hashlib.sha256(rig.records().tobytes())
    for experiment in problem.experiments:
        data.update(experiment.command.tobytes())
        for channel in experiment.channels:
            data.update(channel.measured.tobytes())
    for free in problem.parameters.free:
        data.update(repr(free).encode())
    return {
        "method": method,
        **({} if plant == "rollout" else {"plant": plant}),
        "seed": seed,
        "p": str(p),
        "segments": segments,
        "settings": repr(settings),
        "data": data.hexdigest(),
    }
