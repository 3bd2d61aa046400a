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
from hydrolek_drake.identification.rolling import Request, residuals_at

TRIED = (1e-2, 1.0, 1e2)
"""Dampings that are tried at once, as multiples of the last one that helped."""


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
        leading: Jacobians are told by rollouts with steps so many times as long, which is enough to lead a fit; 1 for
            the problem's own.
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
    """The same places with slopes where they are not known, and residuals."""
    requests: list[Request] = []
    wanted = [_unknown(place) for place in places]
    for place, columns in zip(places, wanted, strict=True):
        requests.append(Request(place.problem, (place.unit,) if place.residuals is None else ()))
        longer = place.problem.with_step(1.0 if place.exact else leading)
        steps = longer.differences(place.unit, place.problem.scales[place.scale])
        moved = [place.unit + steps * (np.arange(place.unit.size) == i) for i in columns]
        requests.append(Request(longer, (place.unit, *moved) if moved else ()))
    answers = residuals_at(requests, pool, cores)
    now = []
    for number, (place, columns) in enumerate(zip(places, wanted, strict=True)):
        own_there, beside = answers[2 * number : 2 * number + 2]
        if own_there:
            place = replace(place, residuals=own_there[0])
        if columns.size:
            assert place.residuals is not None
            longer, scale = requests[2 * number + 1].problem, place.problem.scales[place.scale]
            steps = longer.differences(place.unit, scale)
            slopes = (
                np.zeros((place.residuals.size, place.unit.size))
                if place.slopes is None
                else place.slopes.copy()
            )
            there, *moved_there = beside
            for i, value in zip(columns, moved_there, strict=True):
                slopes[:, i] = (value - there) / steps[i]
            place = replace(place, slopes=slopes, fresh=columns.size == np.count_nonzero(place.moving))
        now.append(place)
    return now


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
