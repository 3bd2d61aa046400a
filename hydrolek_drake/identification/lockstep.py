"""Many bounded least-squares fits in lockstep: what all of them want to be rolled out goes into tables of lanes.

Levenberg and Marquardt's method (Marquardt, SIAM J. 11 (1963) 431) with several dampings tried at once, which costs
little in lanes, and with slopes that are corrected between Jacobians so that they agree with how the residuals really
changed on the ways that were tried (a multisecant Broyden method; Fang and Saad, Numerical Linear Algebra with
Applications 16 (2009) 197). Parameters stay within their ranges by an active set.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.identification.least_squares import Fit
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.rolling import Request, residuals_at

DAMPED = 1e-2
"""Marquardt's damping at first, as a share of the normal equations' diagonal."""

TRIED = (1e-2, 1.0, 1e2)
"""Dampings that are tried at once, as multiples of the last one that helped."""

KEPT = 0.25
"""Slopes that brought this share of the fall that they promised are corrected and used again."""


@dataclass(frozen=True)
class Place:
    """Where one of the fits stands.

    Attributes:
        problem: whose residuals are fitted.
        moving: which parameters are searched. # (n,)
        unit: place in the unit cube. # (n,)
        residuals: there; None where nobody has asked yet. # (values,)
        slopes: d residuals / d unit, of some place near; NaN in columns that nobody has asked for yet, None for none of
            them. # (values, n)
        fresh: whether the slopes are of this place.
        exact: whether slopes are to be those with the problem's own step.
        damping: that helped last.
        ended: whether nothing is left to gain that would count.
    """

    problem: Problem
    moving: np.ndarray
    unit: np.ndarray
    residuals: np.ndarray | None = None
    slopes: np.ndarray | None = None
    fresh: bool = False
    exact: bool = False
    damping: float = DAMPED
    ended: bool = False

    @property
    def objective(self) -> float:
        """Squared residuals, and squared distances from the prior."""
        assert self.residuals is not None
        off = self.problem.prior_residuals(self.unit)
        return float(self.residuals @ self.residuals + off @ off)

    def at(self, problem: Problem) -> "Place":
        """The same place of another problem of the same parameters, led by the same slopes if it has as many values."""
        if (
            self.slopes is None
            or _values_of(problem) != len(self.slopes)
            or problem.pull_time != self.problem.pull_time
        ):
            return Place(problem, self.moving, self.unit, damping=self.damping)
        return Place(problem, self.moving, self.unit, slopes=self.slopes, damping=self.damping)


def fit_of(place: Place) -> Fit:
    """A place as one where a fit ended.

    Args:
        place: with residuals.
    """
    problem, unit, residuals, moving = place.problem, place.unit, place.residuals, place.moving
    assert residuals is not None
    return Fit(
        unit=unit,
        residuals=residuals,
        off_prior=problem.prior_residuals(unit),
        slopes=lambda: problem.jacobian(unit, residuals, moving),
        prior_jacobian=problem.prior_jacobian(),
        counted=problem.counted,
        evaluations=problem.evaluations,
        unsure=problem.unsure,
    )


def _values_of(problem: Problem) -> int:
    """How many residuals a problem has."""
    return sum(len(e.channels) * e.time.size for e in problem.experiments)


def descend(
    places: Sequence[Place],
    rounds: int,
    pool: Executor,
    cores: int,
    *,
    worth: float = 1.0,
    share: float = 1e-3,
    leading: float = 2.0,
    stop: Callable[[], None] = lambda: None,
) -> list[Place]:
    """Go down from several places at once.

    Args:
        places: where the fits stand.
        rounds: so many steps of each at most, each with a Jacobian or with corrected slopes.
        pool: threads.
        cores: that roll out at the same time.
        worth: a fit ends where a step promises or takes less than so many squares, ...
        share: ... or less than this share of what is left.
        leading: Jacobians are told by rollouts with steps so many times as long, which is enough to lead a fit; 1 for
            the problem's own.
        stop: asked before each round; it raises what ends the descent.
    """
    now = list(places)
    for _ in range(rounds):
        stop()
        going = [i for i, place in enumerate(now) if not place.ended]
        if not going:
            break
        for i, place in zip(going, with_slopes([now[i] for i in going], pool, cores, leading), strict=True):
            now[i] = place
        for i, place in zip(going, _stepped([now[i] for i in going], pool, cores, worth, share), strict=True):
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
        steps = longer.differences(place.unit)
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
            steps = requests[2 * number + 1].problem.differences(place.unit)
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


def _stepped(places: Sequence[Place], pool: Executor, cores: int, worth: float, share: float) -> list[Place]:
    """Each place after one step: the best of several dampings."""
    plans = [_Normal(place) for place in places]
    ways = [
        [plan.step(place.damping * times) for times in TRIED]
        for plan, place in zip(plans, places, strict=True)
    ]
    tried = [
        [way for way in own if plan.promised(way) > max(worth, share * place.objective)]
        for own, plan, place in zip(ways, plans, places, strict=True)
    ]
    answers = residuals_at(
        [
            Request(p.problem, tuple(p.unit + way for way in own))
            for p, own in zip(places, tried, strict=True)
        ],
        pool,
        cores,
    )
    now = []
    for place, plan, own, every, found in zip(places, plans, tried, ways, answers, strict=True):
        if not own:
            # what slopes of another place promise nothing of, new ones may
            now.append(_with_better_slopes(place) or replace(place, ended=True))
            continue
        dampings = [
            place.damping * times
            for way, times in zip(every, TRIED, strict=True)
            if any(way is w for w in own)
        ]
        reached = [
            replace(place, unit=np.clip(place.unit + way, 0.0, 1.0), residuals=residuals, fresh=False)
            for way, residuals in zip(own, found, strict=True)
        ]
        best = min(range(len(own)), key=lambda i: reached[i].objective)
        fall = place.objective - reached[best].objective
        promised = plan.promised(own[best])
        if fall <= 0.0:
            now.append(_without_gain(place, dampings))
            continue
        there = replace(reached[best], damping=float(np.clip(dampings[best], 1e-8, 1e8)))
        good = fall > KEPT * promised
        slopes = _corrected(place, own, found) if good else None
        if fall < max(worth, share * place.objective):
            there = _with_better_slopes(replace(there, fresh=place.fresh)) or replace(there, ended=True)
            now.append(replace(there, fresh=False))
        else:
            now.append(replace(there, slopes=slopes))
    return now


def _with_better_slopes(place: Place) -> Place | None:
    """A place whose slopes are to be computed again, or with the problem's own step; None where they are."""
    if not place.fresh:
        return replace(place, slopes=None)
    return None if place.exact else replace(place, slopes=None, exact=True)


def _without_gain(place: Place, dampings: Sequence[float]) -> Place:
    """A place from which no step has helped: with better slopes, then with shorter steps, then it is an end."""
    better = _with_better_slopes(place)
    if better is not None:
        return better
    if max(dampings) > 1e4 * DAMPED:
        return replace(place, ended=True)
    return replace(place, damping=1e6 * place.damping)


def _corrected(place: Place, ways: Sequence[np.ndarray], found: Sequence[np.ndarray]) -> np.ndarray:
    """The slopes nearest to those of a place that agree with how the residuals changed on some ways. # (values, n)."""
    assert place.slopes is not None and place.residuals is not None
    usable = [i for i in range(len(ways)) if np.abs(found[i]).max() < 1e6]
    if not usable:
        return place.slopes
    along = np.stack([ways[i] for i in usable], axis=1)
    change = np.stack([found[i] - place.residuals for i in usable], axis=1)
    return place.slopes + (change - place.slopes @ along) @ np.linalg.pinv(along, rcond=0.05)


class _Normal:
    """The normal equations at a place."""

    def __init__(self, place: Place) -> None:
        """Form them.

        Args:
            place: with residuals and slopes.
        """
        assert place.slopes is not None and place.residuals is not None
        prior = place.problem.prior_jacobian()
        off = place.problem.prior_residuals(place.unit)
        self._square = place.slopes.T @ place.slopes + prior.T @ prior
        self._pull = -(place.slopes.T @ place.residuals + prior.T @ off)
        self._unit, self._moving = place.unit, place.moving

    def step(self, damping: float) -> np.ndarray:
        """Marquardt's step within the ranges, by an active set. # (n,)."""
        free = self._moving & (np.diag(self._square) > 0.0)
        way = np.zeros(self._unit.size)
        for _ in range(self._unit.size):
            index = np.flatnonzero(free)
            if not index.size:
                break
            square = self._square[np.ix_(index, index)]
            held = ~free
            pull = self._pull[index] - self._square[np.ix_(index, np.flatnonzero(held))] @ way[held]
            damped = square + damping * np.diag(np.diag(square))
            own = np.linalg.lstsq(damped, pull, rcond=None)[0]
            low, high = -self._unit[index], 1.0 - self._unit[index]
            beyond = (own < low) | (own > high)
            way[index] = np.clip(own, low, high)
            if not beyond.any():
                break
            free[index[beyond]] = False
        return way

    def promised(self, way: np.ndarray) -> float:
        """By how much the squares fall on a way, if the slopes hold."""
        return float(2.0 * self._pull @ way - way @ self._square @ way)


def normal_step(place: Place) -> np.ndarray:
    """The way to the lowest place if the slopes hold, within the ranges. # (n,)."""
    return _Normal(place).step(1e-6)
