"""Iterated local search: fits from places near the best one of a structure whose squares have many local minima.

Two fits of a structure that end in different minima say that there are more (Boender and Rinnooy Kan, Mathematical
Programming 37, 1987, 59), and better ones are likelier near a good one than elsewhere (Lourenco, Martin and Stuetzle,
Iterated local search, Handbook of Metaheuristics, 2003, 321). Play is of this kind: with every contact that comes a
little earlier or later the movement goes on otherwise.
"""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.cost import gain_needed
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def has_other_minima(best: Hypothesis, ended: Sequence[Hypothesis]) -> bool:
    """Whether fits of a structure have ended in different minima.

    Args:
        best: the structure.
        ended: fits of this one and of others, those in the same minimum but once.
    """
    return sum(h.ids == best.ids for h in ended) > 1


def searched_near(bench: Workbench, structure: Hypothesis) -> Hypothesis:
    """The best fit of a structure that is found near one, as long as each round finds a better one.

    Args:
        bench: data and problems.
        structure: a fit.
    """
    best = structure
    for turn in range(bench.settings.near_rounds):
        near = _places_near(bench, best, np.random.default_rng(turn))
        now = race(bench, [Entrant(best.effects, values) for values in near], bench.settings.near)[0]
        trace(f"    near {best.label}: {best.fit.over_noise:.4f} to {now.fit.over_noise:.4f}")
        gain = best.fit.objective - now.fit.objective
        best = now if gain > 0.0 else best
        if best.fit.over_noise <= NOISE.at or gain < gain_needed(best.fit):
            break
    return best


def _places_near(bench: Workbench, structure: Hypothesis, rng: np.random.Generator) -> list[dict[str, float]]:
    """Values of the parameters at some distances in all directions, and where the structure is."""
    parameters = bench.parameters(structure.effects)
    unit = parameters.unit(structure.values)
    moving = bench.movable(structure.effects, parameters)
    found = [structure.values]
    for spread in bench.settings.near_spreads:
        for _ in range(bench.settings.near_each):
            away = np.where(moving, spread * rng.standard_normal(unit.size), 0.0)
            found.append(parameters.values(np.clip(unit + away, 0.0, 1.0)))
    return found
