"""Fitted effects held on both sides of their sizes: ends of intervals by the squares there, not by curvature.

Where a place bends sharply curvature says that a size is known far better than it is.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.watching.fitting.rungs import Rung, led_on
from hydrolek_drake.watching.fitting.scanning import strength, strengths
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import (
    AROUND,
    HELD,
    HELD_AT,
    LEAST_RISE,
    MOST_RISE,
    WORTH,
)


@dataclass
class _Side:
    """One side of a fitted size: how many deviations off it is held next, and where."""

    candidate: Candidate
    sign: float
    times: float = HELD_AT
    done: bool = False


def around(
    session: Session, fits: Mapping[str, Place], candidates: Mapping[str, Candidate], near: Sequence[str]
) -> tuple[dict[str, Place], dict[str, list[Rung]]]:
    """Fitted effects held on both sides of their sizes, where curvature has the ends of an interval.

    Where that is lower than the fit, the fit goes on from there. Where the squares rise by much less or more than the
    curvature says, the effect is held farther off or nearer, too.

    Args:
        session: rig and reference.
        fits: of the model with one effect each, with slopes, by the effect's path.
        candidates: the effects.
        near: paths of those that do not only imitate the best one, whose ends of an interval are told.

    Returns:
        The fits, and each effect held at these sizes and at its own.
    """
    scale, now = session.posterior.scale, dict(fits)
    rungs = {path: [_own(candidates[path], place)] for path, place in now.items()}
    sides = {path: [_Side(candidates[path], sign) for sign in (-1.0, 1.0)] for path in near}
    for _ in range(AROUND):
        begun = [
            (path, side, rung)
            for path, own in sides.items()
            for side in own
            if not side.done and (rung := _off(now[path], side, scale)) is not None
        ]
        ended = led_on(session, [rung for _, _, rung in begun])
        for (path, side, _), rung in zip(begun, ended, strict=True):
            rungs[path].append(rung)
            rise = max(rung.place.objective - now[path].objective, 0.0) / scale
            side.done = LEAST_RISE < rise < MOST_RISE
            side.times *= float(np.clip(HELD_AT / np.sqrt(max(rise, 1e-9)), 0.25, 4.0))
        lower = [p for p in near if _lowest(rungs[p]).place.objective < now[p].objective - WORTH * scale]
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
