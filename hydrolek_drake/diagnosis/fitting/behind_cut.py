"""Structures of a machine whose chain is cut at its recorded supply pressure: what they are behind the cut."""

from collections.abc import Sequence
from dataclasses import replace

from hydrolek_drake.diagnosis.fitting.entrants import Entrant
from hydrolek_drake.diagnosis.fitting.parts import acts_behind, behind_supply
from hydrolek_drake.diagnosis.fitting.race import race
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis, key_of
from hydrolek_drake.diagnosis.structures.workbench import Workbench


def behind_of(bench: Workbench, seeds: Sequence[Hypothesis]) -> list[Hypothesis]:
    """Structures of all of the machine without what they add before the cut, the best of each."""
    kept: dict[frozenset[str], Hypothesis] = {}
    for each in sorted(seeds, key=lambda h: h.fit.over_noise):
        effects = tuple(c for c in each.effects if acts_behind(bench.rig, c.size_path))
        kept.setdefault(key_of(effects), replace(each, effects=effects))
    return list(kept.values())


def fitted_behind(bench: Workbench, structure: Hypothesis) -> tuple[Workbench, Hypothesis] | None:
    """What lies behind the recorded pressure of a pump, fitted for itself from where all of the machine was.

    Args:
        bench: data and problems of all of the machine.
        structure: fitted to all of the machine.

    Returns:
        Data and problems, and the structure; None where there is no cut.
    """
    part = behind_supply(bench)
    if part is None:
        return None
    [behind] = behind_of(bench, [structure])
    [fitted] = race(part, [Entrant(behind.effects, behind.values)], (bench.settings.again,))
    bench.evaluations += part.evaluations
    return part, fitted
