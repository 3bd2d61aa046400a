"""A search over lanes along one parameter, with all others changed along their tangents.

What begins at a moment, or opens a contact, lets the squares change in steps: no slope leads there. Values of such a
parameter are tried side by side, each with the other parameters where the linearised residuals ask for them (variable
projection; Golub and Pereyra, Inverse Problems 19 (2003) R1).
"""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.identification.least_squares.normal_equations import normal_step
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.rolling import Request, residuals_at


@dataclass(frozen=True)
class Along:
    """Values of one parameter that are tried.

    Attributes:
        index: of the parameter.
        units: its places. # (k,)
        begun: for a moment, of the size of what begins then: its index, where it does nothing, and where it is tried.
            Another moment has another slope of the size, told by the difference between both.
    """

    index: int
    units: np.ndarray
    begun: tuple[int, float, float] | None = None


def searched_along(
    places: Sequence[Place], ways: Sequence[Along | None], pool: Executor, cores: int
) -> list[Place]:
    """Each place, or the lowest of those that were tried from it.

    Args:
        places: with residuals, and slopes if others are to be changed too.
        ways: what is tried from each; None for nothing.
        pool: threads.
        cores: that roll out at the same time.
    """
    moved = [_moved(place, way) if way is not None else [] for place, way in zip(places, ways, strict=True)]
    found = residuals_at(
        [Request(p.problem, tuple(u)) for p, u in zip(places, moved, strict=True)], pool, cores
    )
    followed = [
        _followed(place, way, units, own) if way is not None else []
        for place, way, units, own in zip(places, ways, moved, found, strict=True)
    ]
    again = residuals_at(
        [Request(p.problem, tuple(u)) for p, u in zip(places, followed, strict=True)], pool, cores
    )
    best = []
    for place, units, own, others, theirs in zip(places, moved, found, followed, again, strict=True):
        reached = [
            replace(place, unit=unit, residuals=residuals, fresh=False, ended=False)
            for unit, residuals in zip([*units, *others], [*own, *theirs], strict=True)
        ]
        best.append(min([place, *reached], key=lambda p: p.objective))
    return best


def lowest_along_each(place: Place, pool: Executor, cores: int) -> Place:
    """The lowest place along any of the parameters over its range, others along their tangents; the same if none is.

    A number that acts from a threshold on has a slope on one side of it only, and a fit that begins on the other side
    does not cross it.

    Args:
        place: with residuals and slopes.
        pool: threads.
        cores: that roll out at the same time.
    """
    units = (np.arange(FITS.places) + 0.5) / FITS.places
    ways = [Along(int(index), units) for index in np.flatnonzero(place.moving)]
    return min(searched_along([place] * len(ways), ways, pool, cores), key=lambda p: p.objective)


def _moved(place: Place, way: Along) -> list[np.ndarray]:
    """Places along one parameter; for a moment the first one without what begins then. # (n,) each."""
    units = []
    for value in way.units:
        unit = place.unit.copy()
        unit[way.index] = value
        if way.begun is not None:
            unit[way.begun[0]] = way.begun[2]
        units.append(unit)
    if way.begun is not None and units:
        without = units[0].copy()
        without[way.begun[0]] = way.begun[1]
        units.insert(0, without)
    return units


def _followed(
    place: Place, way: Along, units: Sequence[np.ndarray], residuals: Sequence[np.ndarray]
) -> list[np.ndarray]:
    """The same places with all parameters but one where the slopes ask for them. # (n,) each."""
    if place.slopes is None or np.isnan(place.slopes).any():
        return list(units)
    moving = place.moving.copy()
    moving[way.index] = False
    steps = []
    for unit, left in zip(units, residuals, strict=True):
        slopes = place.slopes
        if way.begun is not None:
            size, off, tried = way.begun
            slopes = slopes.copy()
            slopes[:, size] = (left - residuals[0]) / (tried - off)
        there = replace(place, unit=unit, residuals=left, moving=moving, slopes=slopes)
        steps.append(np.clip(unit + normal_step(there), 0.0, 1.0))
    return steps
