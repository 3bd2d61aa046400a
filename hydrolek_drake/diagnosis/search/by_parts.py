"""Structures fitted part by part where a pump's pressure was recorded: behind the cut first, and then the supply."""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.laws.additions import of_additions
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Hypothesis, Workbench
from hydrolek_drake.identification.least_squares.continuation import Continuation
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.driven_by import SUPPLY, counts


def can_be_cut(bench: Workbench) -> bool:
    """Whether a pump's pressure is followed, and something of the supply is searched.

    What is left above the noise then is no local minimum of the supply's numbers once they are fitted by parts, so that
    a model that explains the data well enough to be called right need not be searched for others.
    """
    return _way(bench, ()).parts() is not None


def enough_for(bench: Workbench) -> float:
    """Times the noise that need not be explained unless something promises to.

    What a recorded supply pressure does between its samples is no missing physics. Nor is what fits by parts leave of a
    line that rings, which no model tells for long: held-out data are held to as much (`Judged.explains_ahead`), and
    what lies behind the recorded pressure was explained without it.
    """
    if bench.cut:
        return NOISE.explained
    return NOISE.far if can_be_cut(bench) else NOISE.at


def acts_behind(rig: Rig, path: str) -> bool:
    """Whether a number still counts where the recorded supply pressure stands in place of the supply."""
    return counts(path, (SUPPLY,), rig.joints)


def behind_supply(bench: Workbench) -> Workbench | None:
    """The machine behind the recorded pressure of its pump, without the supply's numbers; None where none is.

    Joints that move together are rolled out with the supply that they share.
    """
    parts = None if bench.together else _way(bench, ()).parts()
    if parts is None:
        return None
    own = [free for free in bench.nominal if acts_behind(bench.rig, free.path)]
    return Workbench(
        bench.rig, own, parts, bench.pool, bench.cores, bench.progress, signals_apart=bench.signals_apart
    )


def supply_before(
    bench: Workbench, structure: Hypothesis, known: Sequence[Mapping[str, float]], cores: int
) -> dict[str, float]:
    """Numbers of the supply before a structure that was fitted behind its recorded pressure: full path -> value.

    Args:
        bench: data and problems.
        structure: as fitted behind the pressure.
        known: numbers of the supply as fitted to other data.
        cores: that roll out at the same time.
    """
    way = _way(bench, structure.effects, cores)
    starts = [way.parameters.unit({**structure.values, **supply}) for supply in ({}, *known)]
    found = way.parameters.values(way.supply_before(starts))
    return {path: value for path, value in found.items() if not acts_behind(bench.rig, path)}


def by_parts(
    bench: Workbench, effects: tuple[Addition, ...], values: Mapping[str, float], cores: int
) -> dict[str, float]:
    """Numbers of a structure by a fit that is cut at the recorded supply pressure; see `least_squares.continuation`.

    Args:
        bench: data and problems.
        effects: of the structure.
        values: full path -> value where it begins; also with no more than those of what it adds.
        cores: that roll out at the same time.

    Returns:
        Full path -> value.
    """
    way = _way(bench, effects, cores)
    parameters = way.parameters
    starts = [parameters.unit(dict(values)), parameters.unit(of_additions(values))]
    if not effects:
        starts[1] = np.full(len(parameters), 0.5)
    unit = way.from_the_cut(starts)
    assert unit is not None
    return parameters.values(unit)


def _way(bench: Workbench, effects: tuple[Addition, ...], cores: int = 1) -> Continuation:
    """Fits of a structure by continuation."""
    parameters = bench.parameters(effects)
    prior = np.full(len(parameters), np.inf)
    prior[: len(bench.nominal)] = SPREAD

    def told(evaluations: int, over_noise: float, unit: np.ndarray) -> None:
        bench.evaluations += evaluations
        trace(f"  by parts {over_noise:.4f}")

    return Continuation(
        parameters,
        tuple(bench.training),
        bench.pool,
        cores,
        bench.step_for(effects),
        prior,
        bench.alive,
        told,
    )
