"""Recordings less what the step of the integration adds to a model: deferred correction.

What a longer step does wrong is not noise. It is the same time and again, and where the sensors are quiet it bends
numbers by more than their standard deviations: with air in the oil and pressures that are measured, by one to two at
half of a rig's own step. At one place it is known, from a rollout with a much shorter step, and it changes little with
the parameters. Taken out of what was measured, it leaves a fit with the longer step that ends where one with the
shorter step would, at the cost of one rollout (V. Pereyra, Iterated deferred corrections for nonlinear operator
equations, Numerische Mathematik 10, 1967, 316).
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.settings import FITS
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.lost_windows import arrivals
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.problem import Problem


def without_step_error(
    problem: Problem, fitted: Hypothesis, step: float, experiments: Sequence[Experiment]
) -> list[Experiment]:
    """The same experiments, what was measured corrected by y_h - y_(h / s) at the fitted place, s `FITS.shorter`.

    The method is of second order: what is left of the step's error is a share of 1 / s^2. Where a rollout diverges
    nothing is corrected.

    Args:
        problem: whose parameters give the records.
        fitted: near the optimum.
        step: h, that of the fit [s].
        experiments: recordings as they are.
    """
    corrected = []
    records = problem.parameters.records(fitted.fit.unit)
    arrived = arrivals(fitted.effects, fitted.values, experiments)
    for recorded, experiment in zip(experiments, arrived, strict=True):
        long, short = (experiment.simulate(records, h).signals for h in (step, step / FITS.shorter))
        channels = []
        for channel in recorded.channels:
            error = getattr(long, channel.model) - getattr(short, channel.model)
            channels.append(replace(channel, measured=channel.measured + np.nan_to_num(error)))
        corrected.append(replace(recorded, channels=tuple(channels)))
    return corrected
