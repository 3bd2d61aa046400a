"""Fits tried elsewhere: what begins at a moment, or has no slope that leads to it, is searched along lines."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.fitting.entrants import Runner
from hydrolek_drake.diagnosis.fitting.line_search import Along, searched_along
from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import descend


def tried_elsewhere(bench: Workbench, runners: Sequence[Runner]) -> list[Runner]:
    """The same with what has no slope tried elsewhere, and fitted on where that helped."""
    now = list(runners)
    most = max((len(r.effects) for r in runners), default=0)
    for number in range(most):
        own = [_ways(r, number) for r in now]
        for turn in range(max(map(len, own), default=0)):
            ways = [each[turn] if turn < len(each) else None for each in own]
            places = searched_along([r.place for r in now], ways, bench.pool, bench.cores)
            moved = [place is not r.place for place, r in zip(places, now, strict=True)]
            places = [p if m else replace(p, ended=True) for p, m in zip(places, moved, strict=True)]
            places = descend(places, 3, bench.pool, bench.cores, stop=bench.alive)
            now = [replace(r, place=place) for r, place in zip(now, places, strict=True)]
    return now


def _ways(runner: Runner, number: int) -> list[Along]:
    """Lines along which one of a structure's additions is tried elsewhere."""
    if number >= len(runner.effects):
        return []
    candidate = runner.effects[number]
    paths = list(runner.place.problem.parameters.paths)
    ways = []
    if candidate.sudden:
        index = paths.index(candidate.size_path)
        free = runner.place.problem.parameters.free[index]
        value = free.from_unit(float(runner.place.unit[index]))
        places = np.clip(
            [free.to_unit(value * stride) for stride in FITS.strides], FITS.negligible, 1.0 - FITS.negligible
        )
        ways.append(Along(index, places))
    grid = (np.arange(FITS.places) + 0.5) / FITS.places
    near = np.array([-1.0, -0.3, -0.1, -0.03, 0.03, 0.1, 0.3, 1.0]) / FITS.places
    for free in candidate.searched:
        index = paths.index(free.path)
        ways.append(Along(index, np.clip(np.concatenate([grid, runner.place.unit[index] + near]), 0.0, 1.0)))
    return ways
