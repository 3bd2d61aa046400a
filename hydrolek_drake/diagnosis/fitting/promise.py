"""What an addition promises beside a fitted structure, and where its fit should begin.

Around a place the residuals are r + J d for a small change d of the structure's own parameters. With an addition at
some size they are r + e. What the own parameters cannot undo of e is its part across the columns of J, and the fall of
the squares if the addition takes its best multiple is (e . r)^2 / (e . e), both across J: the score test (Rao 1948)
with finite differences, which also sees what begins like a play.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.fitting.longest_step import no_longer_than_borne
from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of, problem_with
from hydrolek_drake.diagnosis.fitting.projection import Across, gain_of
from hydrolek_drake.diagnosis.settings import FITS, GAINS, Settings
from hydrolek_drake.diagnosis.structures.addition import Addition, Sized
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.rolling import Request, residuals_at


@dataclass(frozen=True)
class Promise:
    """An addition held against what a structure leaves at a place.

    Attributes:
        candidate: the addition.
        gain: fall of the squares that it promises.
        starts: full path -> value of its parameters, the most promising first.
        visible_from: size (SI) whose gain would be `GAINS.visible`, in proportion to the sizes that were tried; a first
            estimate, see `intervals.visible`.
    """

    candidate: Sized
    gain: float
    starts: tuple[dict[str, float], ...]
    visible_from: float


def promises_at(
    bench: Workbench, place: Place, effects: tuple[Addition, ...], candidates: Sequence[Sized]
) -> list[Promise]:
    """What each of some additions promises at a place, the most promising first.

    Args:
        bench: data and problems.
        place: of a structure, with residuals.
        effects: of that structure.
        candidates: what may be added.
    """
    here_problem = place.problem
    values = here_problem.parameters.values(place.unit)
    no_longer_than_borne(bench, effects, values)
    step = bench.step_for(effects, FITS.coarse)
    fit = hypothesis_of(effects, place, step).fit
    across = Across(fit)
    tried = [(c, start) for c in candidates for start in _tried(c, bench.settings)]
    problems: dict[str, Problem] = {
        c.size_path: problem_with(
            bench, (*effects, c), step, here_problem.experiments, here_problem.pull_time or math.inf
        )
        for c in candidates
    }
    units: dict[str, list[np.ndarray]] = {c.size_path: [] for c in candidates}
    for candidate, start in tried:
        parameters = problems[candidate.size_path].parameters
        units[candidate.size_path].append(parameters.unit({**values, **start}))
    here_as_tried = problem_with(
        bench, effects, step, here_problem.experiments, here_problem.pull_time or math.inf
    )
    answers = residuals_at(
        [
            Request(here_as_tried, (place.unit,)),
            *(Request(problems[c.size_path], tuple(units[c.size_path])) for c in candidates),
        ],
        bench.pool,
        bench.cores,
    )
    here = answers[0][0]
    left = across(np.concatenate([fit.residuals, fit.off_prior]))
    unchanged = np.zeros_like(fit.off_prior)
    promises = []
    for candidate, found in zip(candidates, answers[1:], strict=True):
        starts = _tried(candidate, bench.settings)
        rated = []
        for start, moved in zip(starts, found, strict=True):
            change = across(np.concatenate([moved - here, unchanged]))
            gain = gain_of(change, left)
            power = float(change @ change)
            multiple = np.sqrt(gain / power) if power > 0.0 else 0.0
            rated.append((gain, float(np.sum((left + change) ** 2)), float(multiple), start, change))
        promises.append(_promise(candidate, rated, bench.settings))
    return sorted(promises, key=lambda p: -p.gain)


def _promise(candidate: Sized, rated: list, settings: Settings) -> Promise:
    best = max(rated, key=lambda each: each[0])
    if candidate.sudden:
        starts = tuple(each[3] for each in sorted(_local_minima(rated), key=lambda each: each[1]))
        return Promise(candidate, best[0], starts[: settings.scanned], _visible_from(candidate, rated))
    by_what_is_left = sorted(rated, key=lambda each: each[1])
    scaled = {**best[3]}
    if not candidate.weakens:
        free = candidate.size
        size = scaled[free.path] * float(np.clip(best[2], 0.1, 10.0))
        scaled[free.path] = float(np.clip(size, free.lower, free.upper))
    begun: list[dict[str, float]] = []
    for start in (by_what_is_left[0][3], scaled, *(each[3] for each in by_what_is_left[1:])):
        if start not in begun:
            begun.append(start)
    return Promise(candidate, best[0], tuple(begun[: settings.starts]), _visible_from(candidate, rated))


def _local_minima(rated: list) -> list:
    """Sizes, in the order in which they were tried, beside which more is left on both sides."""
    left = [math.inf, *(each[1] for each in rated), math.inf]
    return [each for i, each in enumerate(rated) if left[i] > left[i + 1] <= left[i + 2]]


def _visible_from(candidate: Sized, rated: list) -> float:
    """Size whose gain would be `GAINS.visible`, in proportion to the larger sizes that were tried; a first estimate."""
    sizes = [(each[3][candidate.size_path], float(each[4] @ each[4])) for each in rated]
    largest = max((abs(size) for size, _ in sizes), default=0.0)
    if candidate.weakens:
        least = min((abs(size) for size, _ in sizes), default=0.0)
        told = [
            size * (power / GAINS.visible) ** 0.5
            for size, power in sizes
            if 0.0 < power and size <= 10.0 * least
        ]
        return max(told, default=0.0)
    told = [
        abs(size) * (GAINS.visible / power) ** 0.5
        for size, power in sizes
        if 0.0 < power and abs(size) >= 0.1 * largest
    ]
    return min(told, default=float("inf"))


def _tried(candidate: Sized, settings: Settings) -> list[dict[str, float]]:
    """Places of an addition's own parameters that are tried."""
    places = []
    for begin in candidate.starts:
        for times in candidate.tried:
            size = begin[candidate.size_path] * (1.0 / times if candidate.weakens else times)
            tried = {**begin, candidate.size_path: size}
            if all(free.lower <= tried[free.path] <= free.upper for free in candidate.free):
                places.append(tried)
    return places
