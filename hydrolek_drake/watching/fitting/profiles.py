"""Squares at a few sizes of every effect, the machine's own numbers fitted anew at each: its profile likelihood.

A nominal model that was fitted first has taken up what it can of an effect, and may stand where its residuals bend
sharply. How far the squares rise from there along a tangent says little of the effect then. So each is held where its
interval would end by its slope, own numbers are moved by what their tangents say, and fitted on with slopes that are
corrected by each rollout (chord and Broyden steps), a rollout a step. Where the squares do not rise as they should, it
is held farther out.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.rolling import Request, residuals_at
from hydrolek_drake.watching.fitting.likelihood import Profile
from hydrolek_drake.watching.fitting.rungs import Rung, followed, held, hopeless, led_on
from hydrolek_drake.watching.fitting.scanning import Scan, at_size, size_of, strength, strengths
from hydrolek_drake.watching.knowledge import Knowledge
from hydrolek_drake.watching.reference import Session
from hydrolek_drake.watching.settings import (
    CHANGED_KEPT,
    CHANGED_LOG2,
    FARTHER,
    FITTED,
    FURTHER_OUT,
    HELD_AT,
    LIKELY,
    MOST_RISE,
    TRIED,
    WORTH,
)


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
        held(session, nominal, scan, strong, experiments, known) for scan in scans for strong in _sizes(scan)
    ]
    if fit_of(nominal).over_noise > NOISE.above * np.sqrt(scale):
        begun += _from_elsewhere(session, nominal, scans, experiments, known)
    if session.changing:
        begun += _over_ranges(session, nominal, scans, experiments, known)
    ended = led_on(session, begun, most)
    for _ in range(FARTHER):
        own = {
            scan.candidate.size_path: [r for r in ended if r.candidate is scan.candidate] for scan in scans
        }
        gains = {
            path: none[path] - min((r.place.objective for r in each), default=np.inf)
            for path, each in own.items()
        }
        most_gain = max(gains.values())
        farther = [
            (scan, strong)
            for scan in scans
            for path in [scan.candidate.size_path]
            if not hopeless(max(gains[path], scan.gain), most_gain, scale)
            for strong in _farther(scan, own[path], none[path], scale)
        ]
        if not farther:
            break
        more = [held(session, nominal, scan, strong, experiments, known) for scan, strong in farther]
        ended += led_on(session, more, most)
    found: dict[str, list[Rung]] = {scan.candidate.size_path: [] for scan in scans}
    for rung in sorted(ended, key=lambda each: each.strong):
        found[rung.candidate.size_path].append(rung)
    return found


def _from_elsewhere(
    session: Session,
    nominal: Place,
    scans: Sequence[Scan],
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> list[Rung]:
    """Promising effects at their likeliest sizes beside own numbers that are not where their tangents lead.

    An effect that has grown large bends the nominal model's own numbers: they stay there, or are those of the
    reference, which says nothing of what changes between recordings.
    """
    changes = np.array([path in session.changing for path in nominal.problem.parameters.paths])
    reference = np.where(changes, nominal.unit, known.mean)
    found = []
    for scan in [scan for scan in scans if scan.gain > TRIED and scan.slope is not None][:FITTED]:
        strong = strength(scan.candidate, scan.start[scan.candidate.size_path])
        rung = held(session, nominal, scan, strong, experiments, known)
        found += [_beside(rung, rung.place.unit, own) for own in (nominal.unit, reference)]
    return found


def _beside(rung: Rung, unit: np.ndarray, own: np.ndarray) -> Rung:
    """An effect where it stands in a place, beside other own numbers."""
    there = np.clip(np.concatenate([own, unit[own.size :]]), 1e-6, 1.0 - 1e-6)
    return replace(rung, place=replace(rung.place, unit=there))


def _over_ranges(
    session: Session,
    nominal: Place,
    scans: Sequence[Scan],
    experiments: Sequence[Experiment],
    known: Knowledge,
) -> list[Rung]:
    """Promising effects at the best of places that fill the ranges of their sizes and of what changes.

    What changes takes up a part of an effect, and the squares have a local minimum for either: a recording whose load
    was fitted without a dry friction shows a twentieth of it, with a narrow interval (as `beginning.nominal_on`).
    """
    paths = nominal.problem.parameters.paths
    changes = np.flatnonzero([path in session.changing for path in paths])
    promising = [scan for scan in scans if scan.gain > TRIED and _sizes(scan)][:FITTED]
    places = qmc.Sobol(changes.size + 1, scramble=False).random_base2(CHANGED_LOG2)
    begun, requests = [], []
    for scan in promising:
        ends = strengths(scan.candidate)
        likeliest = strength(scan.candidate, scan.start[scan.candidate.size_path])
        most = ends[1] if likeliest > 0.0 else ends[0]
        least = min(abs(likeliest), HELD_AT * scan.deviation, abs(most))
        sizes = np.sign(likeliest) * least * (abs(most) / least) ** places[:, -1]
        first = held(session, nominal, scan, likeliest, experiments, known)
        parameters, rungs = first.place.problem.parameters, []
        for place, strong in zip(places, sizes.tolist(), strict=True):
            own = known.mean.copy()
            own[changes] = place[:-1]
            values = at_size(scan.candidate, scan.start, size_of(scan.candidate, strong))
            rungs.append(_beside(replace(first, strong=strong), parameters.unit(values), own))
        begun.append(rungs)
        requests.append(Request(rungs[0].place.problem, tuple(rung.place.unit for rung in rungs)))
    found = []
    for rungs, answers in zip(begun, residuals_at(requests, session.bench.pool, session.cores), strict=True):
        there = [
            replace(rung, place=replace(rung.place, residuals=residuals))
            for rung, residuals in zip(rungs, answers, strict=True)
        ]
        found += sorted(there, key=lambda rung: rung.place.objective)[:CHANGED_KEPT]
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
    """Strengths beyond those that were tried, on sides where the farthest is still likely, and nearer ones.

    Nearer where the slope promised a gain that no size has: a tangent holds for small sizes.
    """
    found: list[float] = []
    if not rungs:
        return found
    lowest = min(none, *(rung.place.objective for rung in rungs))
    for sign, end in zip((-1.0, 1.0), strengths(scan.candidate), strict=True):
        own = [rung for rung in rungs if rung.strong * sign > 0.0]
        if own:
            last = max(own, key=lambda rung: rung.strong * sign)
            if (last.promised - lowest) / scale < LIKELY and FURTHER_OUT * abs(last.strong) <= abs(end):
                found.append(FURTHER_OUT * last.strong)
    if scan.gain > TRIED and none - lowest < scan.gain / FURTHER_OUT:
        likeliest = strength(scan.candidate, scan.start[scan.candidate.size_path])
        tried = [rung.strong for rung in rungs if rung.strong * likeliest > 0.0]
        found.append(min(tried, key=abs) / FURTHER_OUT)
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
    squares |= dict(zip(shares, (p.objective for p in followed(session, places)), strict=True))
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
