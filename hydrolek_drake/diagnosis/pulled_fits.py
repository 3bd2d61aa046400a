"""Fits with rollouts that are pulled to the measurements: from far off, along valleys, and let go again."""

import itertools
from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.candidates import Candidate
from hydrolek_drake.diagnosis.effort import LOOK, NEAR
from hydrolek_drake.diagnosis.gains import gain_needed
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.identification.least_squares import PULLED_STEPS, PULLED_TOLERANCE
from hydrolek_drake.identification.problem import PULLS_S

STRIDES = (1.3, 1.1, 1.03)
"""By so many times the size of what is sudden is changed at once, see `with_sizes_walked`."""

LOOSER_S = (0.3, 1.0, 3.0)
"""Time constants of rollouts that are let go, see `let_go`: each sees what piles up over three times as long."""


def fit_pulled(
    bench: Workbench,
    effects: Sequence[Candidate],
    starts: Sequence[dict[str, float]],
    step: float,
    experiments: Sequence[Experiment],
) -> Hypothesis:
    """Fits with pulled rollouts, tightly and then less so (`PULLS_S`), from the start at which they fit best."""
    problem = bench.problem(effects, step, experiments, PULLS_S[0])
    units = [problem.parameters.unit(start) for start in starts]
    errors = [float(np.sum(problem.residuals(unit) ** 2)) for unit in units]
    values = starts[int(np.argmin(errors))]
    for pull_time in PULLS_S:
        fitted = bench.fit(
            effects,
            values,
            step,
            PULLED_STEPS,
            tolerance=PULLED_TOLERANCE,
            experiments=experiments,
            pull_time=pull_time,
            alone=True,
        )
        values = fitted.values
    return fitted


def with_sizes_walked(
    bench: Workbench,
    effects: Sequence[Candidate],
    starts: Sequence[dict[str, float]],
    step: float,
    experiments: Sequence[Experiment],
) -> Hypothesis:
    """See `fit_pulled`; the size of what is sudden goes to where the other parameters fit best beside it.

    What a contact that opens elsewhere does bends all residuals anew, so that least squares moves its size by a
    hundredth while the others make up for it, and the valley is walked along in strides that become shorter (pattern
    search: Hooke and Jeeves, Journal of the ACM 8, 1961).
    """
    fitted = fit_pulled(bench, effects, starts, step, experiments)
    sizes = [candidate.size for candidate in effects if candidate.effect.sudden]
    ways = [way for stride in STRIDES for way in (stride, 1.0 / stride)]
    for size, way in itertools.product(sizes, ways):
        while True:
            there = min(max(way * fitted.values[size.path], size.lower), size.upper)
            other = fit_pulled(bench, effects, [{**fitted.values, size.path: there}], step, experiments)
            if fitted.fit.objective - other.fit.objective <= gain_needed(fitted.fit):
                break
            fitted = other
    return fitted


def let_go(bench: Workbench, pulled: Hypothesis) -> Hypothesis:
    """A model that reaches the noise with pulled rollouts, fitted with ever looser ones; free ones come next.

    Where a joint sticks and slips, what pulled rollouts leave open is enough for the free ones to end in a hollow. What
    each looser one leaves open is less (continuation: Nocedal and Wright, Numerical Optimization, 2006, section 11.3).

    Args:
        bench: data and fits.
        pulled: fitted with `PULL_S` to all training data.
    """
    for pull_time in LOOSER_S:
        if pulled.fit.over_noise > NEAR:  # something is missing, which would lead it astray
            break
        pulled = bench.fit(
            pulled.effects,
            pulled.values,
            pulled.step,
            LOOK,
            tolerance=PULLED_TOLERANCE,
            pull_time=pull_time,
            alone=True,
        )
    return pulled
