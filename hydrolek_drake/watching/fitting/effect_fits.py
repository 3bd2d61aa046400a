"""Fits of the reference's model with one effect each to a recording: from where it stands, and through observers."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend, with_slopes
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.watching.fitting.rungs import Rung, hopeless
from hydrolek_drake.watching.fitting.scanning import Scan
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import (
    BEHIND,
    CONTINUED,
    FITTED,
    FURTHER,
    HOPELESS,
    LED,
    MOST_OF,
    OBSERVED,
    RACED,
    RETRIED,
    ROUNDS,
    TRIED,
    WORTH,
)


def fitted_on(
    places: list[Place], session: Session, rounds: int = ROUNDS, behind: float = 0.0
) -> list[Place]:
    """Fits continued until no step promises anything that counts.

    Args:
        places: where they stand.
        session: rig and reference.
        rounds: so many steps at most.
        behind: a fit ends where a step promises less than this share of how far it is behind the best.
    """
    return descend(places, rounds, session.bench.pool, session.cores, worth=WORTH, share=1e-4, behind=behind)


def fits_of_effects(
    session: Session,
    nominal: Place,
    scans: list[Scan],
    rungs: Mapping[str, Sequence[Rung]],
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> dict[str, Place]:
    """Fits of the nominal model with one effect each, by the effect's path; of those alone that promise something.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted, with slopes.
        scans: what each effect promises beside it.
        rungs: effects held at a few sizes; a fit begins at the best of them.
        experiments: of the recording.
        known: of the machine's own numbers.
    """
    bench, count = session.bench, nominal.unit.size
    best = {path: min(own, key=lambda rung: rung.place.objective).place for path, own in rungs.items() if own}
    promising = {p: place for p, place in best.items() if nominal.objective - place.objective > TRIED}
    candidates = {scan.candidate.size_path: scan.candidate for scan in scans}
    promised = {scan.candidate.size_path: scan.gain for scan in scans}
    chosen = in_reach(session, nominal, promising, promised)[:FITTED]
    begun = []
    for path in chosen:
        place = best[path]
        assert place.slopes is not None
        slopes = place.slopes.copy()
        slopes[:, count:] = np.nan
        moving = bench.movable((candidates[path],), place.problem.parameters)
        begun.append(Place(place.problem, moving, place.unit, place.residuals, slopes))
    ended = dict(zip(chosen, _led(begun, session, LED // 2), strict=True))
    near = in_reach(session, nominal, ended, promised)
    on = _led([ended[path] for path in near], session, LED - LED // 2)
    ended |= dict(zip(near, on, strict=True))
    slopes_led = {path: place.slopes for path, place in ended.items()}
    near = in_reach(session, nominal, ended, promised)[:FURTHER]
    again = [_near_its_end(session, ended[path]) for path in near]
    if len(near) > 1:  # one alone races nobody
        again = fitted_on(again, session, RACED, behind_of(session, BEHIND))
    ended |= dict(zip(near, again, strict=True))
    if near:
        first = min(near, key=lambda path: ended[path].objective)
        [ended[first]] = fitted_on([ended[first]], session)
    for path, start in zip(chosen, begun, strict=True):
        told = (ended[path].slopes, slopes_led[path], start.slopes)
        ended[path] = replace(ended[path], slopes=next(each for each in told if each is not None))
    return {path: place for path, place in ended.items() if place.objective < nominal.objective}


def behind_of(session: Session, share: float) -> float:
    """A share of how far a fit is behind others, below which a step that promises no more ends it; or zero.

    It counts from the noise at least, which nothing is below: where the reference leaves more, that says nothing.
    """
    return share if session.posterior.scale <= NOISE.above**2 else 0.0


def in_reach(
    session: Session, nominal: Place, fits: Mapping[str, Place], promised: Mapping[str, float]
) -> list[str]:
    """Effects whose fits may still become the best one, the best first; others imitate that one at most.

    Nothing is below the noise: where the best leaves no more, what is far above it need not be fitted further.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted.
        fits: of the model with one effect each, by the effect's path.
        promised: by the effect's path, squares by which its scan promised to be lower.
    """
    gains = {path: nominal.objective - place.objective for path, place in fits.items()}
    most, scale = max(gains.values(), default=0.0), session.posterior.scale
    kept = [p for p, gain in gains.items() if not hopeless(max(gain, promised.get(p, 0.0)), most, scale)]
    left = {path: fit_of(fits[path]).over_noise / math.sqrt(scale) for path in kept}
    if min(left.values(), default=np.inf) <= NOISE.at:
        kept = [path for path in kept if left[path] < NOISE.far]
    return sorted(kept, key=lambda path: -gains[path])


def rivals(session: Session, fits: Mapping[str, Place]) -> list[str]:
    """Effects that may be what is there, by what their fits leave; the size of another one needs no further rollouts.

    Args:
        session: rig and reference.
        fits: of the model with one effect each, by the effect's path, at their ends.
    """
    least = min((place.objective for place in fits.values()), default=0.0)
    near = least + HOPELESS * session.posterior.scale
    return [path for path, place in fits.items() if place.objective <= near]


def _near_its_end(session: Session, place: Place) -> Place:
    """A fit that goes on; if nothing but noise is left, with the slopes that end a fit: wider ones only lead there."""
    if fit_of(place).over_noise > NOISE.at * math.sqrt(session.posterior.scale):
        return replace(place, ended=False)
    last = len(place.problem.scales) - 1
    return replace(place, slopes=None, fresh=False, scale=last, exact=True, ended=False)


def _led(begun: Sequence[Place], session: Session, rounds: int, behind: float = 0.0) -> list[Place]:
    """Fits that go on with the slopes that they have, which are corrected by each rollout."""
    pool, cores = session.bench.pool, session.cores
    return descend(begun, rounds, pool, cores, worth=WORTH, share=1e-4, behind=behind, renewing=False)


def by_observers(
    session: Session,
    nominal: Place,
    fits: dict[str, Place],
    scans: list[Scan],
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> dict[str, Place]:
    """Where no effect leads to what the reference leaves, all by continuation; those that are better for it.

    An effect that has grown large bends the nominal model's own numbers: beside these another one promises more, and
    its own fit ends in a local minimum. So all are fitted from the reference's numbers, through observers that forget
    (Ljung, System Identification, 1999, chapter 7), fewer with each of them. What changes between recordings begins
    where the nominal model has it, since the reference says nothing of it.
    """
    least = min((fit_of(place).over_noise for place in fits.values()), default=0.0)
    if least <= NOISE.above * math.sqrt(session.posterior.scale):
        return {}
    changes = np.array([path in session.changing for path in nominal.problem.parameters.paths])
    own_begin = np.where(changes, nominal.unit, known.mean)
    places: list[tuple[Candidate, Place]] = []
    for scan in scans:
        candidate = scan.candidate
        problem = session.problem((candidate,), experiments, known)
        moving = session.bench.movable((candidate,), problem.parameters)
        begun = [scan.start, *candidate.starts[:1]]
        if candidate.size_path in fits:
            fitted = fits[candidate.size_path]
            begun.append(fitted.problem.parameters.values(fitted.unit))
        for values in begun:
            own = {free.path: values[free.path] for free in candidate.free if free.path in values}
            unit = problem.parameters.unit(own)
            unit[: known.mean.size] = own_begin
            places.append((candidate, Place(problem, moving, np.clip(unit, 1e-6, 1.0 - 1e-6))))
    for seconds, steps, keep in OBSERVED:
        pulled = [place.at(place.problem.pulled(seconds)) for _, place in places]
        led = list(
            zip((candidate for candidate, _ in places), fitted_on(pulled, session, steps), strict=True)
        )
        places = sorted(led, key=lambda each: each[1].objective)[:keep]
    free = [place.at(session.problem((candidate,), experiments, known)) for candidate, place in places]
    better: dict[str, Place] = {}
    for (candidate, _), place in zip(places, fitted_on(free, session, CONTINUED), strict=True):
        path = candidate.size_path
        before = better.get(path, fits.get(path))
        if before is None or place.objective < before.objective:
            better[path] = place
    return better


def with_own_slopes(session: Session, fits: Mapping[str, Place], known: int) -> dict[str, Place]:
    """Fits with slopes of the effect where they ended; those of own numbers are such as led there.

    Args:
        session: rig and reference.
        fits: by the effect's path.
        known: how many numbers are the machine's own.
    """
    begun = []
    for place in fits.values():
        slopes = None if place.slopes is None else place.slopes.copy()
        if slopes is not None:
            slopes[:, known:] = np.nan
        begun.append(replace(place, slopes=slopes))
    return dict(zip(fits, with_slopes(begun, session.bench.pool, session.cores), strict=True))


def without_effects(
    session: Session, nominal: Place, fits: Mapping[str, Place], scale: float
) -> Place | None:
    """The nominal model where the best fits with an effect have its own numbers, if that is what they gained; or None.

    Over free rollouts the squares have local minima, and what led out of one may be the way, not the effect: then the
    nominal model takes most of the gain there.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted.
        fits: of the model with one effect each.
        scale: squares that count as one.
    """
    count = nominal.unit.size
    best = sorted(fits.values(), key=lambda place: place.objective)[:RETRIED]
    begun = [
        Place(nominal.problem, nominal.moving, place.unit[:count], slopes=place.slopes[:, :count])
        for place in best
        if place.slopes is not None and place.objective < nominal.objective - TRIED * scale
    ]
    if not begun:
        return None
    # none of so many steps may take less, on average, if they are to take enough
    led = _led(begun, session, LED, behind_of(session, MOST_OF / LED))
    found = min(led, key=lambda place: place.objective)
    gained, taken = nominal.objective - best[0].objective, nominal.objective - found.objective
    if taken < max(MOST_OF * gained, TRIED * scale):
        return None
    return fitted_on([replace(found, slopes=None, ended=False)], session)[0]
