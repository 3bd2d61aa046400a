"""Structures fitted to the training data and to others."""

from collections.abc import Sequence

from hydrolek_drake.diagnosis.fitting.problems import problem_with
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.lockstep import descend
from hydrolek_drake.identification.least_squares.place import Place


def to_both(bench: Workbench, hypothesis: Hypothesis, held_out: Sequence[Experiment]) -> Place:
    """Where the fit of a structure to the training data and others begins.

    Args:
        bench: data and problems.
        hypothesis: the structure, fitted to the training data.
        held_out: the others.
    """
    step = bench.step_for(hypothesis.effects, bench.settings.last.coarse)
    problem = problem_with(bench, hypothesis.effects, step, [*bench.training, *held_out])
    return Place(problem, bench.movable(hypothesis.effects, problem.parameters), hypothesis.fit.unit)


def fitted_to_both(bench: Workbench, places: Sequence[Place], *, renewing: bool) -> list[Place]:
    """Structures fitted to the training data and others.

    Args:
        bench: data and problems.
        places: where they begin.
        renewing: whether slopes are computed anew; else those that they have lead, corrected, as far as they do.
    """
    rung = bench.settings.again
    return descend(
        places,
        rung.rounds,
        bench.pool,
        bench.cores,
        share=rung.share,
        leading=bench.coarsest / bench.settings.last.coarse,
        renewing=renewing,
        stop=bench.alive,
    )


def beyond(both: Place, hypothesis: Hypothesis) -> float:
    """Squares that a fit to the training data and others leaves beyond those of the training data alone.

    Args:
        both: where the fit ended.
        hypothesis: its structure, fitted to the training data.
    """
    return max(both.objective - hypothesis.fit.objective, 0.0)
