"""Many bounded least-squares fits in lockstep: what all of them want to be rolled out goes into tables of lanes.

Several dampings of each step are tried at once, which costs little in lanes. Residuals that change by leaps, as those
of a play whose sides meet a step sooner or later, have slopes over a wide difference that lead down, and none over a
narrow one: fits go on from the first to the second (implicit filtering; Kelley, Implicit Filtering, SIAM 2011).
Direction (`normal_equations`), acceptance and ending (`acceptance`) are apart, as in Optimistix (Rader, Lyons, Kidger,
arXiv:2402.09983).
"""

import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import replace

import numpy as np

from hydrolek_drake.identification.least_squares.acceptance import Ending, Trial, after
from hydrolek_drake.identification.least_squares.normal_equations import NormalEquations
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.problem import ALIKE, Problem
from hydrolek_drake.identification.rolling import Request, residuals_at

TRIED = (1e-2, 1.0, 1e2)
"""Dampings that are tried at once, as multiples of the last one that helped."""

LEAPING = 2.0
"""Slopes of residuals that leap are told by steps so many times the problem's own at most: the rig's, of which such a
structure takes half."""


def descend(
    places: Sequence[Place],
    rounds: int,
    pool: Executor,
    cores: int,
    *,
    worth: float = 1.0,
    share: float = 1e-3,
    behind: float = 0.0,
    leading: float = 2.0,
    goal: float = math.inf,
    renewing: bool = True,
    stop: Callable[[], None] = lambda: None,
) -> list[Place]:
    """Go down from several places at once.

    Args:
        places: where the fits stand.
        rounds: so many steps of each at most, each with a Jacobian or with corrected slopes.
        pool: threads.
        cores: that roll out at the same time.
        worth: a fit ends where a step promises or takes less than so many squares, ...
        share: ... or less than this share of what is left, ...
        behind: ... or less than this share of how far it is behind the best of them and behind the noise: who loses
            by thousands of squares need not be known to one. Where it is above zero the fits race, and one ends too
            that would not come to where the best one is with all the steps that are left, each as good as the next.
        leading: Jacobians are told by rollouts with steps at most so many times as long, if their residuals are nearly
            the same; 1 for the problem's own.
        goal: squares of a fit to the same data that is known already: in a race it is one of them.
        renewing: whether slopes are computed where a place has none that hold; without, a fit ends there, and costs
            a rollout a step.
        stop: asked before each round; it raises what ends the descent.
    """
    now = list(places)
    for number in range(rounds):
        stop()
        going = [
            i for i, place in enumerate(now) if not place.ended and (renewing or place.slopes is not None)
        ]
        if not going:
            break
        for i, place in zip(going, with_slopes([now[i] for i in going], pool, cores, leading), strict=True):
            now[i] = place
        best = min(goal, *(p.objective for p in now if p.residuals is not None))
        ahead = min(best, *(p.problem.counted for p in now))
        ending = Ending(worth, share, behind, ahead, best, rounds - number if behind else math.inf)
        for i, place in zip(going, _stepped([now[i] for i in going], pool, cores, ending), strict=True):
            now[i] = place
    return _with_residuals(now, pool, cores)


def _with_residuals(places: Sequence[Place], pool: Executor, cores: int) -> list[Place]:
    """The same places, with the residuals of those of which they are not known."""
    unknown = [i for i, place in enumerate(places) if place.residuals is None]
    found = residuals_at([Request(places[i].problem, (places[i].unit,)) for i in unknown], pool, cores)
    now = list(places)
    for i, (residuals,) in zip(unknown, found, strict=True):
        now[i] = replace(now[i], residuals=residuals)
    return now


def with_slopes(places: Sequence[Place], pool: Executor, cores: int, leading: float = 2.0) -> list[Place]:
    """The same places with slopes where they are not known, and residuals; `leading` as of `descend`."""
    now = _with_residuals(places, pool, cores)
    wanted = [_unknown(place) for place in now]
    led = _led_by(now, [columns.size > 0 for columns in wanted], pool, cores, leading)
    requests = []
    for place, columns, (problem, _) in zip(now, wanted, led, strict=True):
        steps = problem.differences(place.unit, place.problem.scales[place.scale])
        moved = [place.unit + steps * (np.arange(place.unit.size) == i) for i in columns]
        requests.append(Request(problem, tuple(moved)))
    answers = residuals_at(requests, pool, cores)
    for number, (place, columns, (problem, there)) in enumerate(zip(now, wanted, led, strict=True)):
        if not columns.size:
            continue
        steps = problem.differences(place.unit, place.problem.scales[place.scale])
        slopes = np.zeros((there.size, place.unit.size)) if place.slopes is None else place.slopes.copy()
        for i, value in zip(columns, answers[number], strict=True):
            slopes[:, i] = (value - there) / steps[i]
        now[number] = replace(place, slopes=slopes, fresh=columns.size == np.count_nonzero(place.moving))
    return now


def _led_by(
    places: Sequence[Place], asked: Sequence[bool], pool: Executor, cores: int, leading: float
) -> list[tuple[Problem, np.ndarray]]:
    """Whose rollouts tell the slopes of each place, and the residuals there: those of the longest step that does.

    Slopes lead a fit as long as a longer step gives nearly the same residuals (`ALIKE`; inexact Newton methods: Dembo,
    Eisenstat, Steihaug, 1982). Residuals that leap, as of a joint that sticks and slips, do so elsewhere in longer
    steps, whose slopes lead nowhere: with four times the step fits of a Stribeck friction ended at 3.4 times the noise
    from eight starts by an observer of 0.3 s, with twice the step one at 1.0, and with the step itself at 0.9, each of
    whose Jacobians takes twice as long (wrist that sticks and slips, 84/m02_c). For these it is `LEAPING` at most.

    Args:
        places: with residuals.
        asked: whether a place is asked for slopes.
        pool: threads.
        cores: that roll out at the same time.
        leading: step over the problem's own that is tried first; then halves of it.
    """
    led = []
    for place in places:
        assert place.residuals is not None
        led.append((place.problem, place.residuals))
    left = [i for i, place in enumerate(places) if asked[i] and not place.exact]
    times = leading
    while left and times > 1.0:
        longer = [
            places[i].problem.with_step(min(times, LEAPING) if places[i].problem.leaps else times)
            for i in left
        ]
        told = residuals_at(
            [Request(p, (places[i].unit,)) for i, p in zip(left, longer, strict=True)], pool, cores
        )
        for i, problem, (there,) in zip(left, longer, told, strict=True):
            own = led[i][1]
            if np.linalg.norm(there - own) < ALIKE * np.linalg.norm(own):
                led[i] = (problem, there)
        left = [i for i in left if led[i][0] is places[i].problem]
        times *= 0.5
    return led


def _unknown(place: Place) -> np.ndarray:
    """Parameters of which a place has no slopes. # (k,)."""
    if place.slopes is None:
        return np.flatnonzero(place.moving)
    return np.flatnonzero(place.moving & np.isnan(place.slopes[0]))


def _stepped(places: Sequence[Place], pool: Executor, cores: int, ending: Ending) -> list[Place]:
    """Each place after one step."""
    plans = [NormalEquations(place) for place in places]
    wanted = []
    for place, plan in zip(places, plans, strict=True):
        ways = [(plan.step(place.damping * times), place.damping * times) for times in TRIED]
        promised = [(way, damping, plan.promises(way)) for way, damping in ways]
        wanted.append([each for each in promised if each[2] > ending.least(place)])
    requests = [
        Request(place.problem, tuple(place.unit + way for way, _, _ in own))
        for place, own in zip(places, wanted, strict=True)
    ]
    answers = residuals_at(requests, pool, cores)
    return [
        after(place, [Trial(*each, residuals) for each, residuals in zip(own, found, strict=True)], ending)
        for place, own, found in zip(places, wanted, answers, strict=True)
    ]
