"""Fits of the reference's model with one effect each to a recording: from where it stands, and through observers."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.settings import FITS, NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend, with_slopes
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.scanning import Scan
from hydrolek_drake.watching.settings import (
    CONTINUED,
    EXACT,
    FITTED,
    FURTHER,
    OBSERVED,
    RACED,
    ROUNDS,
    TRIED,
    WORTH,
)


def fitted_on(places: list[Place], session: Session, rounds: int = ROUNDS) -> list[Place]:
    """Fits continued until no step promises anything that counts.

    Args:
        places: where they stand.
        session: rig and reference.
        rounds: so many steps at most.
    """
    return descend(places, rounds, session.bench.pool, session.cores, worth=WORTH, share=1e-4)


def fits_of_effects(
    session: Session, nominal: Place, scans: list[Scan], experiments: Sequence[Experiment], known: Knowledge
) -> dict[str, Place]:
    """Fits of the nominal model with one effect each, by the effect's path; of those alone that promise something.

    Args:
        session: rig and reference.
        nominal: the model without any, fitted, with slopes.
        scans: what each effect promises beside it.
        experiments: of the recording.
        known: of the machine's own numbers.
    """
    chosen = [scan for scan in scans if scan.gain > TRIED][:FITTED]
    assert nominal.slopes is not None
    values = nominal.problem.parameters.values(nominal.unit)
    begun = []
    for scan in chosen:
        candidate = scan.candidate
        problem = session.problem((candidate,), experiments, known)
        moving = session.bench.movable((candidate,), problem.parameters)
        unit = np.clip(problem.parameters.unit({**values, **scan.start}), 1e-6, 1.0 - 1e-6)
        unit[: nominal.unit.size] = nominal.unit
        slopes = np.full((len(nominal.slopes), unit.size), np.nan)
        slopes[:, : nominal.unit.size] = nominal.slopes
        begun.append(Place(problem, moving, unit, slopes=slopes))
    ended = dict(
        zip((scan.candidate.size_path for scan in chosen), fitted_on(begun, session, RACED), strict=True)
    )
    near = sorted(ended, key=lambda path: ended[path].objective)[:FURTHER]
    ended |= dict(zip(near, fitted_on([ended[path] for path in near], session, RACED), strict=True))
    better = {path: place for path, place in ended.items() if place.objective < nominal.objective}
    first = sorted(better, key=lambda path: better[path].objective)[:EXACT]
    again = [replace(better[path], slopes=None, ended=False, exact=False) for path in first]
    better |= dict(zip(first, fitted_on(again, session), strict=True))
    led = _by_observers(session, nominal, better, scans, experiments, known)
    better, first = better | led, [*first, *led]
    renewed = [_renewed(place, path in first, nominal.unit.size) for path, place in better.items()]
    known_there = with_slopes(renewed, session.bench.pool, session.cores)
    return dict(zip(better, known_there, strict=True))


def _by_observers(
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
    for seconds, (steps, keep) in zip(FITS.observers_s, OBSERVED, strict=True):
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


def _renewed(place: Place, every: bool, known: int) -> Place:
    """A place that asks for its slopes anew: for every one, or for those of the effect alone."""
    if every or place.slopes is None:
        return replace(place, slopes=None)
    slopes = place.slopes.copy()
    slopes[:, known:] = np.nan
    return replace(place, slopes=slopes)
