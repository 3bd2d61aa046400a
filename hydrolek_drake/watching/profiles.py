"""Squares at a few sizes of every effect, the machine's own numbers fitted anew at each: its profile likelihood.

A nominal model that was fitted first has taken up what it can of an effect, and may stand where its residuals bend
sharply. How far the squares rise from there along a tangent says little of the effect then. So each is held where its
interval would end by its slope, own numbers are moved by what their tangents say, and fitted on with slopes that are
corrected by each rollout (chord and Broyden steps), a rollout a step. Where the squares do not rise as they should, it
is held farther out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.acceptance import Ending, Trial, after
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.normal_equations import NormalEquations
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.likelihood import Profile
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.scanning import Scan, at_size, size_of, strength, strengths
from hydrolek_drake.watching.settings import (
    AROUND,
    DAMPED,
    FARTHER,
    FURTHER_OUT,
    HELD,
    HELD_AT,
    LEAST_RISE,
    LIKELY,
    MOST_RISE,
    SHORTER,
    TRIED,
    WORTH,
)


@dataclass(frozen=True)
class Rung:
    """An effect held at one size.

    Attributes:
        candidate: the effect.
        strong: its size, as a strength.
        place: of the model with it, its own numbers fitted; `slopes` are those that led there.
    """

    candidate: Candidate
    strong: float
    place: Place

    @property
    def promised(self) -> float:
        """Squares that are left where own numbers go on as far as their slopes promise."""
        plan = NormalEquations(self.place)
        return self.place.objective - max(plan.promises(plan.step(DAMPED)), 0.0)


def rungs_of(
    session: Session,
    nominal: Place,
    scans: Sequence[Scan],
    none: Mapping[str, float],
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> dict[str, list[Rung]]:
    """Every effect held at a few sizes, by its path, ordered by size.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted, with slopes.
        scans: what each effect promises beside it.
        none: squares without each effect, see `without`.
        experiments: of the recording.
        known: of the machine's own numbers.
    """
    scale = session.posterior.scale
    most = nominal.objective + MOST_RISE * scale
    begun = [
        _held(session, nominal, scan, strong, experiments, known) for scan in scans for strong in _sizes(scan)
    ]
    ended = _fitted_on(session, begun, most)
    for _ in range(FARTHER):
        own = {
            scan.candidate.size_path: [r for r in ended if r.candidate is scan.candidate] for scan in scans
        }
        farther = [
            (scan, strong)
            for scan in scans
            for path in [scan.candidate.size_path]
            for strong in _farther(scan, own[path], none[path], scale)
        ]
        if not farther:
            break
        more = [_held(session, nominal, scan, strong, experiments, known) for scan, strong in farther]
        ended += _fitted_on(session, more, most)
    found: dict[str, list[Rung]] = {scan.candidate.size_path: [] for scan in scans}
    for rung in sorted(ended, key=lambda each: each.strong):
        found[rung.candidate.size_path].append(rung)
    return found


def _sizes(scan: Scan) -> list[float]:
    """Strengths at which an effect is held first: where its interval would end by its slope, and its likeliest."""
    candidate = scan.candidate
    if (candidate.sudden and scan.gain <= TRIED) or scan.slope is None or not 0.0 < scan.deviation < np.inf:
        return []
    least, most = strengths(candidate)
    likeliest = strength(candidate, scan.start[candidate.size_path]) if scan.gain > WORTH else 0.0
    sizes = [likeliest + HELD_AT * scan.deviation]
    if least < 0.0:
        sizes.append(likeliest - HELD_AT * scan.deviation)
    if scan.gain > TRIED:
        sizes.append(likeliest)
    return sorted({min(max(each, least), most) for each in sizes} - {0.0})


def _farther(scan: Scan, rungs: Sequence[Rung], none: float, scale: float) -> list[float]:
    """Strengths beyond those that were tried, on sides where the farthest is still likely."""
    found = []
    for sign, end in zip((-1.0, 1.0), strengths(scan.candidate), strict=True):
        own = [rung for rung in rungs if rung.strong * sign > 0.0]
        if own:
            last = max(own, key=lambda rung: rung.strong * sign)
            lowest = min(none, *(rung.place.objective for rung in rungs))
            if (last.promised - lowest) / scale < LIKELY and FURTHER_OUT * abs(last.strong) <= abs(end):
                found.append(FURTHER_OUT * last.strong)
    return found


def without(session: Session, nominal: Place, candidates: Sequence[Candidate]) -> dict[str, float]:
    """Squares without each effect, by its path, with steps of the length that it asks for: these have other errors.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted, with slopes.
        candidates: the effects.
    """
    bench = session.bench
    own = {c.size_path: bench.step_for((c,)) / bench.step_for(()) for c in candidates}
    shares = sorted({share for share in own.values() if share != 1.0})
    places = [
        Place(nominal.problem.with_step(share), nominal.moving, nominal.unit, slopes=nominal.slopes)
        for share in shares
    ]
    squares = {1.0: nominal.objective}
    squares |= dict(zip(shares, (p.objective for p in _followed(session, places)), strict=True))
    return {path: squares[share] for path, share in own.items()}


def profile_of(scan: Scan, rungs: Sequence[Rung], none: float, scale: float) -> Profile:
    """The profile by sizes at which an effect was held, and none; of one that was not, by its scan.

    Args:
        scan: of the effect.
        rungs: of it.
        none: squares without it, see `without`.
        scale: squares that count as one.
    """
    rises = {0.0: 0.0}
    if scan.candidate.sudden and not rungs:
        for branch in scan.branches:
            told = zip(branch.sizes.tolist(), branch.rises(branch.sizes).tolist(), strict=True)
            rises |= {size: min(rise / scale, rises.get(size, np.inf)) for size, rise in told if size}
    elif 0.0 < scan.gain <= TRIED:
        rises[strength(scan.candidate, scan.start[scan.candidate.size_path])] = -scan.gain / scale
    lowest = min([none, *(rung.place.objective for rung in rungs)])
    for rung in rungs:
        # what has not ended may end as low as its slopes promise, but is not the lowest by a promise
        rise = (min(rung.place.objective, max(rung.promised, lowest)) - none) / scale
        if np.isfinite(rise):
            rises[rung.strong] = min(rise, rises.get(rung.strong, np.inf))
    sizes = sorted(rises)
    return Profile(tuple(sizes), tuple(rises[size] for size in sizes))


def _held(
    session: Session,
    nominal: Place,
    scan: Scan,
    strong: float,
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> Rung:
    """An effect held at a size, own numbers where their tangents make the most of what it changes."""
    candidate, count = scan.candidate, nominal.unit.size
    assert nominal.slopes is not None and scan.slope is not None
    problem = session.problem((candidate,), experiments, known)
    own = at_size(candidate, scan.start, size_of(candidate, strong))
    values = {**nominal.problem.parameters.values(nominal.unit), **own}
    unit = np.clip(problem.parameters.unit(values), 1e-6, 1.0 - 1e-6)
    prior = nominal.problem.prior_jacobian()
    square = nominal.slopes.T @ nominal.slopes + prior.T @ prior
    free = np.flatnonzero(np.diag(square) > 0.0)
    pull = nominal.slopes.T @ scan.slope * strong
    way = np.zeros(count)
    way[free] = -np.linalg.lstsq(square[np.ix_(free, free)], pull[free], rcond=None)[0]
    unit[:count] = np.clip(nominal.unit + way, 1e-6, 1.0 - 1e-6)
    slopes = np.zeros((len(nominal.slopes), unit.size))
    slopes[:, :count] = nominal.slopes
    moving = np.arange(unit.size) < count
    return Rung(candidate, strong, Place(problem, moving, unit, slopes=slopes))


def _fitted_on(session: Session, rungs: Sequence[Rung], most: float = np.inf) -> list[Rung]:
    """Own numbers fitted on, with the slopes that there are; each keeps those it began with."""
    places = _followed(session, [rung.place for rung in rungs], most)
    return [
        replace(rung, place=replace(place, slopes=rung.place.slopes, fresh=False, ended=False))
        for rung, place in zip(rungs, places, strict=True)
    ]


def _followed(session: Session, begun: Sequence[Place], most: float = np.inf) -> list[Place]:
    """Places after a few steps with the slopes that there are, a rollout each; a step that fails is damped.

    Args:
        session: rig and reference.
        begun: where they stand.
        most: squares that none which is likely has: one that promises no less ends.
    """
    pool, cores = session.bench.pool, session.cores
    places = descend(begun, 0, pool, cores)
    for _ in range(HELD):
        trials: list[tuple[int, np.ndarray, float]] = []
        for i, place in enumerate(places):
            if place.ended or place.slopes is None:
                continue
            plan = NormalEquations(place)
            way = plan.step(DAMPED * place.damping)
            promised = plan.promises(way)
            if promised > WORTH and place.objective - promised < most:
                trials.append((i, way, promised))
        requests = [Request(places[i].problem, (places[i].unit + way,)) for i, way, _ in trials]
        answers = residuals_at(requests, pool, cores)
        for (i, way, promised), (residuals,) in zip(trials, answers, strict=True):
            place = places[i]
            trial = Trial(way, place.damping, promised, residuals)
            there = after(place, [trial], Ending(WORTH))
            failed = there.objective >= place.objective
            places[i] = replace(place, damping=SHORTER * place.damping) if failed else there
    return places


@dataclass
class _Side:
    """One side of a fitted size: how many deviations off it is held next, and where."""

    candidate: Candidate
    sign: float
    times: float = HELD_AT
    done: bool = False


def around(
    session: Session, fits: Mapping[str, Place], candidates: Mapping[str, Candidate]
) -> tuple[dict[str, Place], dict[str, list[Rung]]]:
    """Fitted effects held on both sides of their sizes, where curvature has the ends of an interval.

    Where that is lower than the fit, the fit goes on from there. Where the squares rise by much less or more than the
    curvature says, the effect is held farther off or nearer, too.

    Args:
        session: rig and reference.
        fits: of the model with one effect each, with slopes, by the effect's path.
        candidates: the effects.

    Returns:
        The fits, and each effect held at these sizes and at its own.
    """
    scale, now = session.posterior.scale, dict(fits)
    rungs = {path: [_own(candidates[path], place)] for path, place in now.items()}
    sides = {path: [_Side(candidates[path], sign) for sign in (-1.0, 1.0)] for path in now}
    for _ in range(AROUND):
        begun = [
            (path, side, rung)
            for path, own in sides.items()
            for side in own
            if not side.done and (rung := _off(now[path], side, scale)) is not None
        ]
        ended = _fitted_on(session, [rung for _, _, rung in begun])
        for (path, side, _), rung in zip(begun, ended, strict=True):
            rungs[path].append(rung)
            rise = max(rung.place.objective - now[path].objective, 0.0) / scale
            side.done = LEAST_RISE < rise < MOST_RISE
            side.times *= float(np.clip(HELD_AT / np.sqrt(max(rise, 1e-9)), 0.25, 4.0))
        lower = [p for p in now if _lowest(rungs[p]).place.objective < now[p].objective - WORTH * scale]
        freed = [replace(_lowest(rungs[p]).place, moving=now[p].moving, slopes=now[p].slopes) for p in lower]
        for path, place in zip(lower, _led(session, freed), strict=True):
            now[path] = replace(place, slopes=now[path].slopes, fresh=False, ended=False)
            rungs[path].append(_own(candidates[path], now[path]))
            for side in sides[path]:
                side.done = False
    return now, rungs


def _lowest(rungs: Sequence[Rung]) -> Rung:
    return min(rungs, key=lambda rung: rung.place.objective)


def _own(candidate: Candidate, place: Place) -> Rung:
    """A fitted effect, held where it is."""
    values = place.problem.parameters.values(place.unit)
    return Rung(candidate, strength(candidate, values[candidate.size_path]), place)


def _off(fitted: Place, side: _Side, scale: float) -> Rung | None:
    """A fitted effect off its size, all other numbers where their tangents go with it; None where it cannot be."""
    assert fitted.slopes is not None
    at = list(fitted.problem.parameters.paths).index(side.candidate.size_path)
    prior = fitted.problem.prior_jacobian()
    square = fitted.slopes.T @ fitted.slopes + prior.T @ prior
    free = np.flatnonzero(fitted.moving & (np.diag(square) > 0.0))
    if at not in free:
        return None
    covariance = np.linalg.pinv(square[np.ix_(free, free)])
    own = int(np.flatnonzero(free == at)[0])
    if not covariance[own, own] > 0.0:
        return None
    upwards = -1.0 if side.candidate.weakens else 1.0
    far = upwards * side.sign * side.times * np.sqrt(scale * covariance[own, own])
    moved = float(np.clip(fitted.unit[at] + far, 0.0, 1.0)) - fitted.unit[at]
    unit = fitted.unit.copy()
    unit[free] = np.clip(unit[free] + covariance[:, own] / covariance[own, own] * moved, 1e-6, 1.0 - 1e-6)
    moving = fitted.moving & (np.arange(unit.size) != at)
    rung = _own(side.candidate, Place(fitted.problem, moving, unit, slopes=fitted.slopes))
    least, most = strengths(side.candidate)
    return rung if moved and least <= rung.strong <= most and rung.strong != 0.0 else None


def _led(session: Session, places: Sequence[Place]) -> list[Place]:
    """Fits that go on with the slopes that they have."""
    return descend(places, HELD, session.bench.pool, session.cores, worth=WORTH, share=1e-4, renewing=False)
