"""Structures that enter a race: where their fits begin, and the slopes that lead them at first."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from hydrolek_drake.diagnosis.fitting.problems import problem_of, problem_with
from hydrolek_drake.diagnosis.settings import FITS, Rung
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.least_squares.lockstep import with_slopes
from hydrolek_drake.identification.least_squares.place import Place
from hydrolek_drake.identification.parameter_set import Free


@dataclass(frozen=True, eq=False)
class Start:
    """Where a structure stands that is enlarged: its slopes lead the fits of all that begin there.

    Attributes:
        effects: of the structure.
        values: full path -> value; what is not named is at the rig's own.
    """

    effects: tuple[Addition, ...]
    values: dict[str, float]

    def with_addition(self, addition: Addition, values: Mapping[str, float]) -> "Entrant":
        """The structure with one addition.

        Args:
            addition: an effect or a term of a law.
            values: full path -> value of its own parameters.
        """
        return Entrant((*self.effects, addition), {**self.values, **values}, self)


@dataclass(frozen=True)
class Entrant:
    """A structure and where its fit begins.

    Attributes:
        effects: what is added to the nominal model.
        values: full path -> start; what is not named starts at the rig's own value.
        start: whose slopes lead it at first; None for its own.
    """

    effects: tuple[Addition, ...]
    values: dict[str, float]
    start: Start | None = None


@dataclass(frozen=True)
class Runner:
    """A structure on its way."""

    effects: tuple[Addition, ...]
    place: Place

    @property
    def key(self) -> frozenset[str]:
        """What tells its structure from others."""
        return frozenset(c.size_path for c in self.effects)

    @property
    def searched(self) -> tuple[Free, ...]:
        """What its place in the unit cube means: parameters in their order with their ranges, which may be wider."""
        return tuple(free for c in self.effects for free in c.free)

    @property
    def label(self) -> str:
        """What tells its structure from others in words."""
        return " + ".join(c.label for c in self.effects) or "nominal model"


def entered(bench: Workbench, entrants: Sequence[Entrant], rung: Rung) -> list[Runner]:
    """Structures at their starts, led by the slopes of the structures that they enlarge.

    Args:
        bench: data and problems.
        entrants: structures and starts.
        rung: the first one.
    """
    runners = [_begun(bench, entrant) for entrant in entrants]
    problems = {r.searched: problem_of(bench, r.effects, rung) for r in runners}
    led = _led(bench, entrants, [r.place.at(problems[r.searched]) for r in runners], rung)
    return [replace(r, place=place) for r, place in zip(runners, led, strict=True)]


def _begun(bench: Workbench, entrant: Entrant) -> Runner:
    problem = problem_with(bench, entrant.effects, bench.step_for(entrant.effects), bench.training)
    moving = bench.movable(entrant.effects, problem.parameters)
    return Runner(
        entrant.effects, Place(problem, moving, _inside(problem.parameters.unit(entrant.values), moving))
    )


def _led(bench: Workbench, entrants: Sequence[Entrant], begun: Sequence[Place], rung: Rung) -> list[Place]:
    """The same places with the slopes where they start, which are nearly their own."""
    starts = list(dict.fromkeys(e.start for e in entrants if e.start is not None))
    places = []
    for start in starts:
        problem = problem_of(bench, start.effects, rung)
        moving = bench.movable(start.effects, problem.parameters)
        places.append(Place(problem, moving, _inside(problem.parameters.unit(start.values), moving)))
    known_at = dict(zip(starts, with_slopes(places, bench.pool, bench.cores), strict=True))
    led = []
    for entrant, place in zip(entrants, begun, strict=True):
        if entrant.start is None:
            led.append(place)
            continue
        known = known_at[entrant.start]
        assert known.slopes is not None
        slopes = np.full((len(known.slopes), place.unit.size), np.nan)
        paths = list(place.problem.parameters.paths)
        for column, path in enumerate(known.problem.parameters.paths):
            if path in paths:
                slopes[:, paths.index(path)] = known.slopes[:, column]
        led.append(replace(place, slopes=slopes))
    return led


def _inside(unit: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """A place a little within the ranges, from where steps to both sides can be made."""
    return np.where(moving, np.clip(unit, FITS.negligible, 1.0 - FITS.negligible), unit)
