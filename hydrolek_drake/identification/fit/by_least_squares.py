"""A rig's parameters by least squares, from its own values and from random ones."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor

import numpy as np

from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import GOOD_ENOUGH, Fit, fit_from, multi_start
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether, problem_of
from hydrolek_drake.identification.secant_descent import SecantDescent

STARTS = 20
"""Starts of the least squares: the rig's own values and random ones."""

WORTH = 0.1
"""Squares that a step of joints that move together must promise: a third of a standard error."""

NEAR_BY_ANGLES = 2.0
"""Times the noise that joints which move together are near with, by their own rollouts: measured angles do not tell how
fast they shake each other, which leaves 1.3 to 1.7 of a machine whose numbers are right."""


def by_least_squares(
    parameters: ParameterSet,
    training: Sequence[Experiment],
    pool: Executor | None,
    rng: np.random.Generator,
    loss: str,
    progress: Callable[[int, float], None] | None,
) -> tuple[Fit, int, bool]:
    """The best of the starts that were finished, rollouts that it took, and whether Ctrl-C ended them early.

    The starts of joints that move together have each joint's own rollouts, with what the measured angles of the others
    tell, which take a tenth of the time and end near; the fit then goes on from the best with what the joints do to
    each other.

    Args:
        parameters: what is searched.
        training: what must be followed.
        pool: threads for the columns of a Jacobian; None for this one.
        rng: of the random starts.
        loss: one of `least_squares.LOSSES`.
        progress: told how many evaluations are done, and the least so far over the noise.
    """
    problem = Problem(parameters, training, pool=pool)
    last = problem_of(parameters, training, pool=pool)
    starts = [parameters.unit(), *rng.uniform(size=(STARTS - 1, len(parameters)))]
    finished: list[Fit] = []

    def told(number: int, best: Fit) -> None:
        finished[:] = [best]
        if progress is not None:
            progress(problem.evaluations + last.evaluations, best.over_noise)

    together = isinstance(last, ProblemTogether)
    enough = NEAR_BY_ANGLES if together else GOOD_ENOUGH
    interrupted = False
    try:
        multi_start(problem, starts, loss=loss, good_enough=enough, progress=told)
        if together:
            told(STARTS, _followed(last, finished[0].unit, loss))
    except KeyboardInterrupt:
        if not finished:
            raise
        interrupted = True
    return finished[0], problem.evaluations + last.evaluations, interrupted


def _followed(together: Problem, start: np.ndarray, loss: str) -> Fit:
    """A fit of joints that move together, gone on with by rollouts of all of them."""
    if loss != "linear":
        return fit_from(together, start, loss=loss)
    every = np.ones(start.size, dtype=bool)
    return SecantDescent(together, worth=WORTH, stop=lambda: False, moving=every).from_start(start)
