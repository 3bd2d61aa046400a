"""Residuals of a structure on a rung of a race, and its fit as the rest of the diagnosis takes it."""

import math
from collections.abc import Sequence

from hydrolek_drake.diagnosis.settings import Rung
from hydrolek_drake.diagnosis.structures.addition import Addition
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether


def problem_of(bench: Workbench, effects: tuple[Addition, ...], rung: Rung) -> Problem:
    """Residuals of a structure on a rung.

    Args:
        bench: data.
        effects: of the structure.
        rung: says which data are followed, in what steps, and by what observer.
    """
    data = bench.training if math.isinf(rung.seconds) else [e.until(rung.seconds) for e in bench.training]
    return problem_with(bench, effects, bench.step_for(effects, rung.coarse), data, rung.observer_s)


def problem_with(
    bench: Workbench,
    effects: tuple[Addition, ...],
    step: float,
    experiments: Sequence[Experiment],
    observer_s: float = math.inf,
) -> Problem:
    """Residuals of a structure; joints that move together are all rolled out at once.

    Args:
        bench: data.
        effects: of the structure.
        step: of the integration [s].
        experiments: what must be followed.
        observer_s: time constant of the observer [s]; infinite for free rollouts.
    """
    kind = ProblemTogether if any(e.others is not None for e in experiments) else Problem
    observer = None if math.isinf(observer_s) else observer_s
    return bench.problem(effects, step, experiments, observer, kind=kind)


def hypothesis_of(effects: tuple[Addition, ...], place: Place, step: float) -> Hypothesis:
    """A fit as the rest of the diagnosis takes it.

    Args:
        effects: of the structure.
        place: where its fit ended.
        step: of the integration [s].
    """
    return Hypothesis(effects, place.problem.parameters.values(place.unit), fit_of(place), step)
