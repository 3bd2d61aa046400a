"""Fits tried elsewhere: what begins at a moment, or has no slope that leads to it, is searched along lines."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hydrolek_drake.diagnosis.fitting.entrants import Runner
from hydrolek_drake.diagnosis.fitting.line_search import Along, searched_along
from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.candidates import Candidate
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend

_GRID = np.arange(FITS.places)
_CLOSER = np.array([1.0, 0.3, 0.1, 0.03])


def tried_elsewhere(bench: Workbench, runners: Sequence[Runner]) -> list[Runner]:
    """The same with what has no slope tried elsewhere, and fitted on where that helped."""
    now = list(runners)
    most = max((len(r.effects) for r in runners), default=0)
    for number in range(most):
        searches = [_searches(r, number) for r in now]
        for turn in range(max(map(len, searches), default=0)):
            ways = [own[turn](r) if turn < len(own) else None for own, r in zip(searches, now, strict=True)]
            places = searched_along([r.place for r in now], ways, bench.pool, bench.cores)
            moved = [place is not r.place for place, r in zip(places, now, strict=True)]
            places = [p if m else replace(p, ended=True) for p, m in zip(places, moved, strict=True)]
            places = descend(places, 3, bench.pool, bench.cores, stop=bench.alive)
            now = [replace(r, place=place) for r, place in zip(now, places, strict=True)]
    return now


def _searches(runner: Runner, number: int) -> list[Callable[[Runner], Along]]:
    """Searches one after the other along which one of a structure's additions is tried elsewhere.

    What begins at a moment is looked for over the whole recording, as large as it is and with its size begun anew, and
    then closer and closer about the best place.
    """
    if number >= len(runner.effects):
        return []
    candidate = runner.effects[number]
    paths = list(runner.place.problem.parameters.paths)
    searches: list[Callable[[Runner], Along]] = []
    if candidate.sudden:
        searches.append(partial(_multiples, index=paths.index(candidate.size_path)))
    for free in candidate.searched:
        index = paths.index(free.path)
        searches.append(partial(_over_range_and_near, index=index))
        if not isinstance(candidate, Candidate):  # a window, which was seen where it is
            continue
        begun = _begun(candidate, paths)
        searches.append(partial(_over_range, index=index, begun=begun))
        for times in range(1, FITS.closer + 1):
            spacing = (2.0 / FITS.places) ** times / FITS.places
            searches.append(partial(_near, index=index, spacing=spacing, begun=begun))
    return searches


def _begun(candidate: Candidate, paths: Sequence[str]) -> tuple[int, float, float]:
    """Of the size of what begins at a moment: its index, where it does nothing, and where it is tried."""
    size = candidate.size
    tried = candidate.starts[0][size.path]
    return paths.index(size.path), size.to_unit(candidate.effect.neutral_size), size.to_unit(tried)


def _over_range(runner: Runner, index: int, begun: tuple[int, float, float]) -> Along:
    """What begins at a moment at places over its range, its size begun anew at each."""
    return Along(index, (_GRID + 0.5) / FITS.places, begun)


def _over_range_and_near(runner: Runner, index: int) -> Along:
    """What has no slope at places over its range, and closer together where it is."""
    near = runner.place.unit[index] + np.concatenate([-_CLOSER, _CLOSER]) / FITS.places
    return Along(index, np.clip(np.concatenate([(_GRID + 0.5) / FITS.places, near]), 0.0, 1.0))


def _multiples(runner: Runner, index: int) -> Along:
    """A size without a slope at multiples of where it is."""
    free = runner.place.problem.parameters.free[index]
    value = free.from_unit(float(runner.place.unit[index]))
    places = [free.to_unit(value * stride) for stride in FITS.strides]
    return Along(index, np.clip(places, FITS.negligible, 1.0 - FITS.negligible))


def _near(runner: Runner, index: int, spacing: float, begun: tuple[int, float, float]) -> Along:
    """What begins at a moment at places on both sides of where it is, its size tried as large as it is."""
    unit, (size, off, _) = runner.place.unit, begun
    if abs(unit[size] - off) > FITS.tolerance:
        begun = (size, off, float(unit[size]))
    places = unit[index] + (_GRID - 0.5 * (FITS.places - 1)) * spacing
    return Along(index, np.clip(places, 0.0, 1.0), begun)
