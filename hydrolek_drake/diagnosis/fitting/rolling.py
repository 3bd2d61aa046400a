"""Residuals of several problems at several places, all rolled out side by side."""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.rollout.lane_view import LANES
from hydrolek_drake.rollout.lanes import kind_of, roll_out_lanes
from hydrolek_drake.rollout.rollout import missing_number, with_own
from hydrolek_drake.rollout.run import Run


@dataclass(frozen=True)
class Request:
    """Places of one problem at which residuals are wanted.

    Attributes:
        problem: whose residuals.
        units: places in the unit cube. # (n,) each
    """

    problem: Problem
    units: tuple[np.ndarray, ...]


def residuals_at(requests: Sequence[Request], pool: Executor, cores: int) -> list[list[np.ndarray]]:
    """Residuals of every request at each of its places, as of `Problem.residuals`.

    Args:
        requests: whatever is wanted at this moment, of any problems.
        pool: threads.
        cores: that roll out at the same time.
    """
    wanted: list[tuple[int, int, int, Run]] = []
    for number, request in enumerate(requests):
        request.problem.evaluations += len(request.units)
        for place, unit in enumerate(request.units):
            wanted += [(number, place, part, run) for part, run in enumerate(request.problem.runs(unit))]
    parts: dict[tuple[int, int, int], np.ndarray] = {}

    def table(chunk: Sequence[tuple[int, int, int, Run]]) -> None:
        for (number, place, part, _), done in zip(chunk, roll_out_lanes([run for *_, run in chunk]), strict=True):
            experiment = requests[number].problem.experiments[part]
            parts[number, place, part] = experiment.residuals(done.signals)

    list(pool.map(table, _chunks(wanted, cores)))
    return [
        [
            request.problem.bounded([parts[number, place, part] for part in range(len(request.problem.experiments))])
            for place in range(len(request.units))
        ]
        for number, request in enumerate(requests)
    ]


def _chunks(wanted: Sequence[tuple[int, int, int, Run]], cores: int) -> list[list[tuple[int, int, int, Run]]]:
    """Tables of lanes of one kind; where there are few, as many as there are cores."""
    groups: dict[tuple[str, int, float], list[tuple[int, int, int, Run]]] = {}
    for each in wanted:
        groups.setdefault(_alike(each[3]), []).append(each)
    chunks = []
    for group in groups.values():
        size = LANES
        if len(groups) == 1 and LANES < len(group) < cores * LANES:
            size = -(-len(group) // cores)
        chunks += [group[at : at + size] for at in range(0, len(group), size)]
    return sorted(chunks, key=len, reverse=True)


def _alike(run: Run) -> tuple[str, int, float]:
    """What machines that go into one table of lanes have in common."""
    if missing_number(run.joint) is not None:
        return ("", 0, 0.0)
    kind = kind_of(run.joint, run.spool_steps, with_own(run.law, run.joint))
    return (kind.name, len(run.times), run.longest_step)
