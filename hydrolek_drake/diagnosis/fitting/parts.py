"""The two parts of a machine whose pump's pressure was recorded: what lies behind it, and the supply before it.

The chain is cut there (`Experiment.cut_at_supply`): the recorded pressure drives what lies behind it, and the supply is
followed under the flow that this draws.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from hydrolek_drake.diagnosis import trace
from hydrolek_drake.diagnosis.settings import NOISE
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.weighing import least_over_noise
from hydrolek_drake.diagnosis.structures.workbench import SPREAD, Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.continuation import Continuation, cut_where_measured
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.driven_by import SUPPLY, counts


def cut(bench: Workbench, experiments: Sequence[Experiment]) -> tuple[Experiment, ...]:
    """Experiments cut where a pump's pressure was recorded; themselves where none was."""
    return cut_where_measured(bench.parameters(()), experiments)


def enough_for(bench: Workbench) -> float:
    """Times the noise that need not be explained unless something promises to.

    What a recorded supply pressure does between its samples is no missing physics, nor is what the rig says that its
    equations leave at best.
    """
    return max(NOISE.explained if bench.cut else NOISE.at, least_over_noise(bench.training))


def acts_behind(rig: Rig, path: str) -> bool:
    """Whether a number still counts where the recorded supply pressure stands in place of the supply."""
    return counts(path, (SUPPLY,), rig.joints)


def behind_supply(bench: Workbench) -> Workbench | None:
    """The machine behind the recorded pressure of its pump, without the supply's numbers; None where it is not cut."""
    if not bench.cut:
        return None
    own = [free for free in bench.nominal if acts_behind(bench.rig, free.path)]
    parts = [e.behind_cut() for e in bench.training]
    return Workbench(
        bench.rig,
        own,
        parts,
        bench.pool,
        bench.cores,
        bench.progress,
        settings=bench.settings,
        signals_apart=bench.signals_apart,
        coarsest=bench.coarsest,
    )


def supply_before(
    bench: Workbench,
    effects: tuple[Addition, ...],
    values: Mapping[str, float],
    known: Sequence[Mapping[str, float]],
) -> list[dict[str, float]]:
    """Numbers of the supply before a structure whose others are known, the best first: full path -> value.

    Args:
        bench: data and problems.
        effects: of the structure; what it adds to the supply is found too.
        values: full path -> value of the others.
        known: numbers of the supply as fitted before.
    """
    parameters = bench.parameters(effects)
    prior = np.full(len(parameters), np.inf)
    prior[: len(bench.numbers(effects))] = SPREAD

    def told(evaluations: int, over_noise: float, unit: np.ndarray) -> None:
        bench.evaluations += evaluations
        trace(f"  supply {over_noise:.4f}")

    way = Continuation(
        parameters,
        tuple(bench.training),
        bench.pool,
        bench.cores,
        bench.step_for(effects),
        prior,
        bench.alive,
        told,
    )
    starts = [parameters.unit({**values, **supply}) for supply in ({}, *known)]
    found = [parameters.values(unit) for unit in way.supply_before(starts)]
    return [{path: v for path, v in each.items() if not acts_behind(bench.rig, path)} for each in found]
