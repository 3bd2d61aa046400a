"""A race of structures: all are fitted a little, the better ones more (successive halving).

Jamieson and Talwalkar, Non-stochastic best arm identification and hyperparameter optimization, AISTATS 2016.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.fitting.elsewhere import tried_elsewhere
from hydrolek_drake.diagnosis.fitting.entrants import Entrant, Runner, entered
from hydrolek_drake.diagnosis.fitting.problems import hypothesis_of, problem_of
from hydrolek_drake.diagnosis.settings import FITS, GAINS, NOISE, Rung
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend


def race(
    bench: Workbench,
    entrants: Sequence[Entrant],
    rungs: Sequence[Rung],
    seen: Callable[[Sequence[Runner], Rung], None] = lambda runners, rung: None,
    goal: float = math.inf,
) -> list[Hypothesis]:
    """Fit structures, the better ones to the end.

    Args:
        bench: data and problems.
        entrants: structures and starts.
        rungs: of the race.
        seen: told how the fits stand after each rung.
        goal: squares of a known fit to the same data, as of `lockstep.descend`.

    Returns:
        Those that ended on the last rung, the best first.
    """
    runners = run(bench, entered(bench, entrants, rungs[0]), rungs, seen, goal)
    return hypotheses_of(bench, runners, rungs[-1])


def run(
    bench: Workbench,
    runners: Sequence[Runner],
    rungs: Sequence[Rung],
    seen: Callable[[Sequence[Runner], Rung], None] = lambda runners, rung: None,
    goal: float = math.inf,
) -> list[Runner]:
    """Structures on their way through rungs, the best first.

    Args:
        bench: data and problems.
        runners: structures and where they stand.
        rungs: of the race.
        seen: told how the fits stand after each rung.
        goal: squares of a known fit to the same data, as of `lockstep.descend`.
    """
    now = list(runners)
    for number, rung in enumerate(rungs):
        problems = {r.searched: problem_of(bench, r.effects, rung) for r in now}
        told = bench.progress.rounds([r.label for r in now], rungs, number, bench.alive)
        places = descend(
            [r.place.at(problems[r.searched]) for r in now],
            rung.rounds,
            bench.pool,
            bench.cores,
            share=rung.share,
            behind=rung.behind,
            goal=goal,
            leading=max(bench.coarsest / rung.coarse, 1.0),
            stop=told,
        )
        bench.evaluations += sum(p.evaluations for p in problems.values())
        now = [replace(r, place=place) for r, place in zip(now, places, strict=True)]
        if rung.elsewhere:
            now = tried_elsewhere(bench, now)
        part = math.isfinite(min(rung.observer_s, rung.seconds))
        now = _ranked(now) if part else sorted(now, key=lambda r: r.place.objective)
        if now and not part:
            best = now[0].place
            over_noise = math.sqrt(best.objective / max(best.problem.counted, 1))
            bench.progress.reached(now[0].label, over_noise)
        seen(now, rung)
        now = _distinct(now, rung.each)
        if not (rung is rungs[-1] and math.isinf(rung.observer_s)):
            now = _in_reach(now, few=math.isfinite(rung.observer_s))
        now = now[: rung.keep]
    return now


def hypotheses_of(bench: Workbench, runners: Sequence[Runner], rung: Rung) -> list[Hypothesis]:
    """Fits of a rung as the rest of the diagnosis takes them."""
    return [hypothesis_of(r.effects, r.place, bench.step_for(r.effects, rung.coarse)) for r in runners]


def _ranked(runners: Sequence[Runner]) -> list[Runner]:
    """The best first of structures that an observer follows, or that the beginning of the data is shown.

    Squares of the same data that differ by less than one more addition must bring do not tell structures apart: what
    promised most goes on.
    """
    best = min((r.place.objective for r in runners), default=0.0)

    def told_apart(runner: Runner) -> float:
        place = runner.place
        return max(place.objective, best + GAINS.of_one_more(place.problem.counted))

    return sorted(runners, key=told_apart)


def _at_noise(runner: Runner) -> float:
    """Squares up to which a fit may be at the noise, to two standard deviations of them, or at what equations leave."""
    count = runner.place.problem.counted
    return NOISE.at**2 * count + 2.0 * math.sqrt(2.0 * count) + runner.place.problem.admitted


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
        known = any(abs(squares - other) <= FITS.tolerance * other for other in before)
        if len(before) < count and not known:
            before.append(squares)
            chosen.append(runner)
    return chosen


def _in_reach(runners: Sequence[Runner], *, few: bool) -> list[Runner]:
    """Those that may still come to where the best one is: nothing is below the noise.

    Args:
        runners: the best first.
        few: whether fits have few local minima, so that who lies behind does so for good also far from the noise.
    """
    if not runners:
        return []
    best = min((r.place for r in runners), key=lambda place: place.objective)
    if not few and best.objective > NOISE.at**2 * best.problem.counted:
        return list(runners)
    return [r for r in runners if r.place.objective <= NOISE.far**2 * best.objective]
