"""A rig's parameters by least squares: by continuation, from its own values and from random ones."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor

import numpy as np

from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.continuation import Continuation
from hydrolek_drake.identification.least_squares.least_squares import GOOD_ENOUGH, Fit, fit_from
from hydrolek_drake.identification.least_squares.place import Place, fit_of
from hydrolek_drake.identification.least_squares.secant_descent import SecantDescent
from hydrolek_drake.identification.parameter_set import ParameterSet
from hydrolek_drake.identification.problem import Problem
from hydrolek_drake.identification.problem_together import ProblemTogether, problem_of

ROUNDS = 10
"""So often two starts are tried: the rig's own values and the middle of its ranges, then random ones."""

ALIKE = 0.01
"""A round that ends with the least squares of those before, to this share of them, has found what there is."""

WORTH = 0.1
"""Squares that a step of joints that move together must promise: a third of a standard error."""

NEAR_BY_ANGLES = 2.0
"""Times the noise that joints which move together are near with, by their own rollouts: measured angles do not tell how
fast they shake each other, which leaves 1.3 to 1.7 of a machine whose numbers are right."""


def by_least_squares(
    parameters: ParameterSet,
    training: Sequence[Experiment],
    pool: Executor | None,
    workers: int,
    rng: np.random.Generator,
    loss: str,
    progress: Callable[[int, float], None] | None,
) -> tuple[Fit, int, bool]:
    """The best of the fits that were finished, rollouts that it took, and whether Ctrl-C ended them early.

    Where none was finished it is the place that the first one had reached, or the rig's own.

    It ends with the first round that is at the noise, or that ends where another one did. The fits of joints that move
    together have each joint's own rollouts, with what the measured angles of the others tell, which take a tenth of the
    time and end near; the fit then goes on from the best with what the joints do to each other.

    Args:
        parameters: what is searched.
        training: what must be followed.
        pool: threads for the columns of a Jacobian; None for this one.
        workers: threads that roll out at the same time.
        rng: of the random starts.
        loss: one of `least_squares.LOSSES`.
        progress: told how many evaluations are done, and the least so far over the noise.
    """
    problem = Problem(parameters, training, pool=pool)
    last = problem_of(parameters, training, pool=pool)
    finished: list[Fit] = []
    done, reached = 0, parameters.unit()

    def told(evaluations: int, over_noise: float, unit: np.ndarray) -> None:
        nonlocal done, reached
        done, reached = done + evaluations, unit
        if progress is not None:
            known = min([over_noise, *(fit.over_noise for fit in finished)])
            progress(done + problem.evaluations + last.evaluations, known)

    together = isinstance(last, ProblemTogether)
    enough = NEAR_BY_ANGLES if together else GOOD_ENOUGH
    interrupted = False
    try:
        with ThreadPoolExecutor(workers) as threads:
            way = Continuation(parameters, tuple(training), threads, workers, told=told)
            starts = [parameters.unit(), np.full(len(parameters), 0.5)]
            for _ in range(ROUNDS):
                fit = _ended(problem, way.from_starts(starts), loss)
                again = bool(finished) and abs(fit.objective / finished[0].objective - 1.0) < ALIKE
                finished = sorted([*finished, fit], key=_objective)
                if again or fit.over_noise <= enough:
                    break
                starts = list(rng.uniform(size=(2, len(parameters))))
        if together:
            finished = [_followed(last, finished[0].unit, loss)]
    except KeyboardInterrupt:
        interrupted = True
        finished = finished or [min((_at(problem, u) for u in (parameters.unit(), reached)), key=_objective)]
    return finished[0], done + problem.evaluations + last.evaluations, interrupted


def _ended(problem: Problem, place: Place, loss: str) -> Fit:
    """A place as a fit; with a robust loss it goes on from there."""
    if loss != "linear":
        return fit_from(problem, place.unit, loss=loss)
    return _at(problem, place.unit, place.residuals)


def _objective(fit: Fit) -> float:
    return fit.objective


def _at(problem: Problem, unit: np.ndarray, known: np.ndarray | None = None) -> Fit:
    """A place as one where a fit ended, with its residuals if they are known. # unit: (n,)."""
    residuals = problem.residuals(unit) if known is None else known
    return fit_of(Place(problem, np.ones(unit.size, dtype=bool), unit, residuals))


def _followed(together: Problem, start: np.ndarray, loss: str) -> Fit:
    """A fit of joints that move together, gone on with by rollouts of all of them."""
    if loss != "linear":
        return fit_from(together, start, loss=loss)
    every = np.ones(start.size, dtype=bool)
    return SecantDescent(together, worth=WORTH, stop=lambda: False, moving=every).from_start(start)
