"""How much each measured value counts: weights from the noise and the model error that show beside a model."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.data.joints_together import felt_together
from hydrolek_drake.diagnosis.lost_commands.windows import arrivals
from hydrolek_drake.diagnosis.settings import DATA, NOISE
from hydrolek_drake.diagnosis.structures.as_rig import rig_of
from hydrolek_drake.diagnosis.structures.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.channel import faithful
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.replay.noise import noise_level


def weighted_by(
    bench: Workbench, hypothesis: Hypothesis, experiments: Sequence[Experiment]
) -> list[Experiment]:
    """The same experiments with noise, model error and response to the start as they show beside this model.

    A recorded signal's own movement passes for noise where it is fast; most of it is gone in the residual.
    The error of the integration is told from a second rollout with half the step: the method is of second
    order, so the coarser one is wrong by 4/3 of their difference. What joints that move at the same time do
    is told by rolling out all joints where the model is near the noise, and known to `DATA.others_unknown` elsewhere.
    """
    problem = bench.problem(hypothesis.effects, bench.fine, experiments)
    records = problem.parameters.records(problem.parameters.unit(hypothesis.values))
    if hypothesis.fit.over_noise < NOISE.far and any(e.others is not None for e in experiments):
        experiments = felt_together(rig_of(bench.rig, hypothesis), experiments)
    better = []
    arrived = arrivals(hypothesis.effects, hypothesis.values, experiments)
    for recorded, experiment in zip(experiments, arrived, strict=True):
        coarse = experiment.simulate(records, bench.fine).signals
        fine = experiment.simulate(records, 0.5 * bench.fine).signals
        alone = None
        if experiment.others is not None and experiment.others_error is None:
            alone = replace(experiment, others=None).simulate(records, 0.5 * bench.fine).signals
        channels = []
        for number, channel in enumerate(experiment.channels):
            model = getattr(fine, channel.model)
            level = noise_level(channel.measured - model)
            error = 4.0 / 3.0 * np.abs(getattr(coarse, channel.model) - model)
            if experiment.others_error is not None:
                error = np.hypot(error, experiment.others_error[number])
            if alone is not None:
                error = np.hypot(error, DATA.others_unknown * (model - getattr(alone, channel.model)))
            channels.append(
                replace(
                    channel,
                    noise=min(channel.noise, max(level, faithful(channel.measured))),
                    model_error=np.nan_to_num(error),
                )
            )
        response = experiment.responding(records, 0.5 * bench.fine, fine)
        better.append(replace(recorded, channels=tuple(channels), start_response=response))
    return better
