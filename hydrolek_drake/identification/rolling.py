"""Residuals of several problems at several places, all rolled out side by side."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial

import numpy as np

from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether
from hydrolek_drake.rollout.lanes.kinds import kind_of
from hydrolek_drake.rollout.lanes.lanes import roll_out_lanes
from hydrolek_drake.rollout.lanes.view import LANES
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
    alone: list[_Wanted] = []
    found: dict[tuple[int, int], np.ndarray] = {}
    parts: dict[tuple[int, int, int], np.ndarray] = {}
    tables: list[Callable[[], None]] = []
    for number, request in enumerate(requests):
        problem = request.problem
        if isinstance(problem, ProblemTogether) and problem.pull_time is None:
            tables += _together(number, request, found)
            continue
        problem.evaluations += len(request.units)
        for place, unit in enumerate(request.units):
            alone += [_Wanted(number, place, part, run) for part, run in enumerate(problem.runs(unit))]

    def table(chunk: Sequence[_Wanted]) -> None:
        for each, done in zip(chunk, roll_out_lanes([each.run for each in chunk]), strict=True):
            experiment = requests[each.number].problem.experiments[each.part]
            parts[each.number, each.place, each.part] = experiment.residuals(done.signals)

    tables += [partial(table, chunk) for chunk in _chunks(alone, cores)]
    list(pool.map(_done, tables))
    return [
        [
            found[number, place]
            if (number, place) in found
            else request.problem.bounded(
                [parts[number, place, part] for part in range(len(request.problem.experiments))]
            )
            for place in range(len(request.units))
        ]
        for number, request in enumerate(requests)
    ]


@dataclass(frozen=True)
class _Wanted:
    """A rollout that is wanted.

    Attributes:
        number: of the request.
        place: of its units.
        part: of its problem's experiments.
        run: the rollout.
    """

    number: int
    place: int
    part: int
    run: Run


def _done(table: Callable[[], None]) -> None:
    table()


def _together(
    number: int, request: Request, found: dict[tuple[int, int], np.ndarray]
) -> list[Callable[[], None]]:
    """Tables of a machine whose joints are all rolled out at once."""

    def table(first: int) -> None:
        units = request.units[first : first + LANES]
        for place, residuals in enumerate(request.problem.residuals_of_all(units), start=first):
            found[number, place] = residuals

    return [partial(table, first) for first in range(0, len(request.units), LANES)]


def _chunks(wanted: Sequence[_Wanted], cores: int) -> list[list[_Wanted]]:
    """Tables of lanes of one kind; where there are few, as many as there are cores."""
    groups: dict[tuple[str, int, float], list[_Wanted]] = {}
    for each in wanted:
        groups.setdefault(_alike(each.run), []).append(each)
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
