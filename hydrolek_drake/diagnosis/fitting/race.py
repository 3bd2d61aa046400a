"""A race of structures: all are fitted a little, the better ones more (successive halving).

Jamieson and Talwalkar, Non-stochastic best arm identification and hyperparameter optimization, AISTATS 2016.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.fitting.line_search import Along, searched_along
from hydrolek_drake.diagnosis.settings import FITS, NOISE, Rung
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend, with_slopes
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.parameter_set import Free
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether


@dataclass(frozen=True, eq=False)
class Start:
    """Where a structure stands that is enlarged: its slopes lead the fits of all that begin there.

    Attributes:
        effects: of the structure.
        values: full path -> value; what is not named is at the rig's own.
    """

    effects: tuple[Addition, ...]
    values: dict[str, float]

    def with_addition(self, addition: Addition, values: Mapping[str, float]) -> "Entrant":
        """The structure with one addition.

        Args:
            addition: an effect or a term of a law.
            values: full path -> value of its own parameters.
        """
        return Entrant((*self.effects, addition), {**self.values, **values}, self)


@dataclass(frozen=True)
class Entrant:
    """A structure and where its fit begins.

    Attributes:
        effects: what is added to the nominal model.
        values: full path -> start; what is not named starts at the rig's own value.
        start: whose slopes lead it at first; None for its own.
    """

    effects: tuple[Addition, ...]
    values: dict[str, float]
    start: Start | None = None


@dataclass(frozen=True)
class Runner:
    """A structure on its way."""

    effects: tuple[Addition, ...]
    place: Place

    @property
    def key(self) -> frozenset[str]:
        """What tells its structure from others."""
        return frozenset(c.size_path for c in self.effects)

    @property
    def searched(self) -> tuple[Free, ...]:
        """What its place in the unit cube means: parameters in their order with their ranges, which may be wider."""
        return tuple(free for c in self.effects for free in c.free)

    @property
    def label(self) -> str:
        """What tells its structure from others in words."""
        return " + ".join(c.label for c in self.effects) or "nominal model"


def race(
    bench: Workbench,
    entrants: Sequence[Entrant],
    rungs: Sequence[Rung],
    cores: int,
    seen: Callable[[Sequence[Runner], Rung], None] = lambda runners, rung: None,
) -> list[Hypothesis]:
    """Fit structures, the better ones to the end.

    Args:
        bench: data and problems.
        entrants: structures and starts.
        rungs: of the race.
        cores: that roll out at the same time.
        seen: told how the fits stand after each rung.

    Returns:
        Those that ended on the last rung, the best first.
    """
    runners = run(bench, entered(bench, entrants, rungs[0], cores), rungs, cores, seen)
    return hypotheses_of(bench, runners, rungs[-1])


def entered(bench: Workbench, entrants: Sequence[Entrant], rung: Rung, cores: int) -> list[Runner]:
    """Structures at their starts, led by the slopes of the structures that they enlarge.

    Args:
        bench: data and problems.
        entrants: structures and starts.
        rung: the first one.
        cores: that roll out at the same time.
    """
    runners = [_begun(bench, entrant) for entrant in entrants]
    problems = {r.searched: problem_of(bench, r.effects, rung) for r in runners}
    led = _led(bench, entrants, [r.place.at(problems[r.searched]) for r in runners], rung, cores)
    return [replace(r, place=place) for r, place in zip(runners, led, strict=True)]


def run(
    bench: Workbench,
    runners: Sequence[Runner],
    rungs: Sequence[Rung],
    cores: int,
    seen: Callable[[Sequence[Runner], Rung], None] = lambda runners, rung: None,
) -> list[Runner]:
    """Structures on their way through rungs, the best first.

    Args:
        bench: data and problems.
        runners: structures and where they stand.
        rungs: of the race.
        cores: that roll out at the same time.
        seen: told how the fits stand after each rung.
    """
    now = list(runners)
    for number, rung in enumerate(rungs):
        problems = {r.searched: problem_of(bench, r.effects, rung) for r in now}
        told = bench.progress.rounds([r.label for r in now], rungs, number, bench.alive)
        places = descend(
            [r.place.at(problems[r.searched]) for r in now],
            rung.rounds,
            bench.pool,
            cores,
            share=rung.share,
            stop=told,
        )
        bench.evaluations += sum(p.evaluations for p in problems.values())
        now = [replace(r, place=place) for r, place in zip(now, places, strict=True)]
        if rung.elsewhere:
            now = tried_elsewhere(bench, now, cores)
        part = math.isfinite(min(rung.observer_s, rung.seconds))
        now = sorted(now, key=_told_apart if part else lambda r: r.place.objective)
        if now and not part:
            best = now[0].place
            over_noise = math.sqrt(best.objective / max(best.problem.counted, 1))
            bench.progress.reached(now[0].label, over_noise)
        seen(now, rung)
        last = rung is rungs[-1]
        now = _distinct(now, rung.each)
        now = (now if last or part else _in_reach(now))[: rung.keep]
    return now


def hypotheses_of(bench: Workbench, runners: Sequence[Runner], rung: Rung) -> list[Hypothesis]:
    """Fits of a rung as the rest of the diagnosis takes them."""
    return [hypothesis_of(r.effects, r.place, rung.coarse * bench.fine) for r in runners]


def tried_elsewhere(bench: Workbench, runners: Sequence[Runner], cores: int) -> list[Runner]:
    """The same with what has no slope tried elsewhere, and fitted on where that helped."""
    now = list(runners)
    most = max((len(r.effects) for r in runners), default=0)
    for number in range(most):
        own = [_ways(r, number) for r in now]
        for turn in range(max(map(len, own), default=0)):
            ways = [each[turn] if turn < len(each) else None for each in own]
            places = searched_along([r.place for r in now], ways, bench.pool, cores)
            moved = [place is not r.place for place, r in zip(places, now, strict=True)]
            places = [p if m else replace(p, ended=True) for p, m in zip(places, moved, strict=True)]
            places = descend(places, 3, bench.pool, cores, stop=bench.alive)
            now = [replace(r, place=place) for r, place in zip(now, places, strict=True)]
    return now


def _ways(runner: Runner, number: int) -> list[Along]:
    """Lines along which one of a structure's additions is tried elsewhere."""
    if number >= len(runner.effects):
        return []
    candidate = runner.effects[number]
    paths = list(runner.place.problem.parameters.paths)
    ways = []
    if candidate.sudden:
        index = paths.index(candidate.size_path)
        free = runner.place.problem.parameters.free[index]
        value = free.from_unit(float(runner.place.unit[index]))
        places = np.clip(
            [free.to_unit(value * stride) for stride in FITS.strides], FITS.negligible, 1.0 - FITS.negligible
        )
        ways.append(Along(index, places))
    grid = (np.arange(FITS.places) + 0.5) / FITS.places
    near = np.array([-1.0, -0.3, -0.1, -0.03, 0.03, 0.1, 0.3, 1.0]) / FITS.places
    for free in candidate.searched:
        index = paths.index(free.path)
        ways.append(Along(index, np.clip(np.concatenate([grid, runner.place.unit[index] + near]), 0.0, 1.0)))
    return ways


def _led(
    bench: Workbench, entrants: Sequence[Entrant], begun: Sequence[Place], rung: Rung, cores: int
) -> list[Place]:
    """The same places with the slopes where they start, which are nearly their own."""
    starts = list(dict.fromkeys(e.start for e in entrants if e.start is not None))
    places = []
    for start in starts:
        problem = problem_of(bench, start.effects, rung)
        moving = bench.movable(start.effects, problem.parameters)
        places.append(Place(problem, moving, _inside(problem.parameters.unit(start.values), moving)))
    known_at = dict(zip(starts, with_slopes(places, bench.pool, cores), strict=True))
    led = []
    for entrant, place in zip(entrants, begun, strict=True):
        if entrant.start is None:
            led.append(place)
            continue
        known = known_at[entrant.start]
        assert known.slopes is not None
        slopes = np.full((len(known.slopes), place.unit.size), np.nan)
        paths = list(place.problem.parameters.paths)
        for column, path in enumerate(known.problem.parameters.paths):
            if path in paths:
                slopes[:, paths.index(path)] = known.slopes[:, column]
        led.append(replace(place, slopes=slopes))
    return led


def _inside(unit: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """A place a little within the ranges, from where steps to both sides can be made."""
    return np.where(moving, np.clip(unit, FITS.negligible, 1.0 - FITS.negligible), unit)


def _told_apart(runner: Runner) -> float:
    """Squares by which structures are ranked that an observer follows, or that the beginning of the data is shown.

    What reaches the noise there, to two standard deviations of its squares, is not told apart by it: what promised most
    goes on.
    """
    return max(runner.place.objective, _at_noise(runner))


def _at_noise(runner: Runner) -> float:
    """Squares up to which a fit may be at the noise, to two standard deviations of them."""
    count = runner.place.problem.counted
    return NOISE.at**2 * count + 2.0 * math.sqrt(2.0 * count)


def above_noise(runner: Runner) -> bool:
    """Whether a structure surely leaves more than noise on its rung."""
    return runner.place.objective > _at_noise(runner)


def _distinct(runners: Sequence[Runner], count: int) -> list[Runner]:
    """At most so many fits of each structure, in different minima, the best first."""
    kept: dict[frozenset[str], list[float]] = {}
    chosen = []
    for runner in runners:
        before = kept.setdefault(runner.key, [])
        squares = runner.place.objective
        if len(before) < count and (not before or squares > (1.0 + FITS.tolerance) * before[-1]):
            before.append(squares)
            chosen.append(runner)
    return chosen


def _in_reach(runners: Sequence[Runner]) -> list[Runner]:
    """Those that may still come to where the best one is: nothing is below the noise."""
    best = runners[0].place
    if best.objective > NOISE.at**2 * best.problem.counted:
        return list(runners)
    return [r for r in runners if r.place.objective <= NOISE.far**2 * best.objective]


def problem_of(bench: Workbench, effects: tuple[Addition, ...], rung: Rung) -> Problem:
    """Residuals of a structure on a rung."""
    data = bench.training if math.isinf(rung.seconds) else [e.until(rung.seconds) for e in bench.training]
    return problem_with(bench, effects, rung.coarse * bench.fine, data, rung.observer_s)


def problem_with(
    bench: Workbench,
    effects: tuple[Addition, ...],
    step: float,
    experiments: Sequence[Experiment],
    observer_s: float = math.inf,
) -> Problem:
    """Residuals of a structure; joints that move together are all rolled out at once.

    Args:
        bench: data.
        effects: of the structure.
        step: of the integration [s].
        experiments: what must be followed.
        observer_s: time constant of the observer [s]; infinite for free rollouts.
    """
    kind = ProblemTogether if any(e.others is not None for e in experiments) else Problem
    observer = None if math.isinf(observer_s) else observer_s
    return bench.problem(effects, step, experiments, observer, kind=kind)


def _begun(bench: Workbench, entrant: Entrant) -> Runner:
    problem = problem_with(bench, entrant.effects, bench.fine, bench.training)
    moving = bench.movable(entrant.effects, problem.parameters)
    return Runner(
        entrant.effects, Place(problem, moving, _inside(problem.parameters.unit(entrant.values), moving))
    )


def hypothesis_of(effects: tuple[Addition, ...], place: Place, step: float) -> Hypothesis:
    """A fit as the rest of the diagnosis takes it."""
    return Hypothesis(effects, place.problem.parameters.values(place.unit), fit_of(place), step)
