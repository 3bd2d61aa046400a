"""How much each measured value counts: weights from the noise and the model error that show beside a model.

Joints of one arm shake each other on their oil, faster than smoothed angles tell. Near the noise that matters: a
healthy machine would look as if something were missing. A rollout of all joints with a fitted model's values tells it.
Its motion and flows then stand as known inputs of each joint's own rollout, which gives the same movement at these
values (`experiments.neighbours`), and nearly so at values close by: the fit goes on with them and asks again.

**Discrepancy of each signal.** Where no structure comes near the noise of any signal, what is left is the model's own
error and not the sensor's, and a signal with little noise would decide alone. Its variance is then estimated for each
signal, as is most likely: by what the fitted model leaves of it (Kennedy, O'Hagan, Bayesian calibration of computer
models, J. Royal Statistical Society B 63, 2001). Only ratios count here, their common size is a parameter of the cost.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from hydrolek_drake.diagnosis.settings import DATA, NOISE
from hydrolek_drake.diagnosis.structures.as_rig import rig_of
from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.lost_windows import arrivals
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.channel import faithful
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.neighbours import probes_of
from hydrolek_drake.identification.experiments.recorded_together import OneRecording, recordings_of
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.together.together import Together


def weighted_by(
    bench: Workbench,
    hypothesis: Hypothesis,
    experiments: Sequence[Experiment],
    observer_s: float = math.inf,
) -> list[Experiment]:
    """The same experiments with noise, model error and response to the start as they show beside this model.

    A recorded signal's own movement passes for noise where it is fast; most of it is gone in the residual.
    The error of the integration is told from a second rollout with half the step: the method is of second
    order, so the coarser one is wrong by 4/3 of their difference. What joints that move at the same time do
    is told by rolling out all joints where the model is near the noise, and known to `DATA.others_unknown` elsewhere.
    What a signal that is recorded in place of a part of the model does between its samples is told by leaving out every
    other one.

    Args:
        bench: data and problems.
        hypothesis: the model.
        experiments: training or held-out data.
        observer_s: time constant of the observer that follows them [s]; infinite for free rollouts.
    """
    of_training = experiments is bench.training
    pull_time = None if math.isinf(observer_s) else observer_s
    step = bench.step_for(hypothesis.effects)
    problem = bench.problem(hypothesis.effects, step, experiments)
    records = problem.parameters.records(problem.parameters.unit(hypothesis.values))
    # an observer holds the others to what was measured, which its fit need not foretell
    near = pull_time is None and hypothesis.fit.over_noise < NOISE.far
    if near and any(e.others is not None for e in experiments):
        experiments = felt_in_each(partial(_rig_in, bench, hypothesis), experiments)
    better = []
    arrived = arrivals(hypothesis.effects, hypothesis.values, experiments)
    for recorded, experiment in zip(experiments, arrived, strict=True):
        coarse = experiment.simulate(records, step, pull_time=pull_time).signals
        fine = experiment.simulate(records, 0.5 * step, pull_time=pull_time).signals
        alone = None
        if experiment.others is not None and experiment.others_error is None:
            alone = (
                replace(experiment, others=None).simulate(records, 0.5 * step, pull_time=pull_time).signals
            )
        sparse = experiment.with_every_other_of_recorded()
        between = (
            fine
            if sparse is experiment
            else sparse.simulate(records, 0.5 * step, pull_time=pull_time).signals
        )
        channels = []
        for number, channel in enumerate(experiment.channels):
            model = getattr(fine, channel.model)
            # an observer takes a share of the noise into its state, so that what it leaves does not tell the noise
            level = noise_level(channel.measured - model) if pull_time is None else channel.noise
            error = 4.0 / 3.0 * np.abs(getattr(coarse, channel.model) - model)
            if sparse is not experiment:
                error = np.hypot(error, getattr(between, channel.model) - model)
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
        response = experiment.responding(records, 0.5 * step, fine, pull_time)
        better.append(replace(recorded, channels=tuple(channels), start_response=response))
    if not bench.signals_apart or pull_time is not None:
        return better
    shares = _discrepancies(better, arrived, records) if of_training else _told(bench.training)
    return [_with_discrepancies(e, shares) for e in better]


def _discrepancies(
    weighted: Sequence[Experiment], arrived: Sequence[Experiment], records: np.ndarray
) -> dict[str, float]:
    """Discrepancy of each signal over that of the one that a model follows best; none where it is near the noise.

    Args:
        weighted: experiments with the noise that shows beside the model.
        arrived: the same with the commands that arrived.
        records: the fitted model.
    """
    squares: dict[str, list[np.ndarray]] = {}
    for experiment, driven in zip(weighted, arrived, strict=True):
        signals = driven.simulate(records, experiment.longest_step).signals
        for channel in experiment.channels:
            plain = replace(channel, discrepancy=1.0)
            left = ((channel.measured - getattr(signals, channel.model)) / plain.deviation)[experiment.used]
            squares.setdefault(channel.key, []).append(left[np.isfinite(left)] ** 2)
    leaves = {key: float(np.sqrt(np.concatenate(found).mean())) for key, found in squares.items()}
    least = min(leaves.values())
    return {key: value / least if least > NOISE.far else 1.0 for key, value in leaves.items()}


def _told(experiments: Sequence[Experiment]) -> dict[str, float]:
    return {channel.key: channel.discrepancy for e in experiments for channel in e.channels}


def _with_discrepancies(experiment: Experiment, shares: dict[str, float]) -> Experiment:
    channels = tuple(replace(c, discrepancy=shares.get(c.key, 1.0)) for c in experiment.channels)
    return replace(experiment, channels=channels)


def felt_together(rig: Rig, experiments: Sequence[Experiment]) -> list[Experiment]:
    """The same experiments, those of joints that move together with what the others do by rolling out all.

    Where that leaves all bounds they stay as they are.

    Args:
        rig: the machine with the values of a fitted model.
        experiments: of one or more recordings.
    """
    return felt_in_each(lambda recording: rig, experiments)


def _rig_in(bench: Workbench, hypothesis: Hypothesis, recording: str) -> Rig:
    """The machine with a structure's values as it was in a recording."""
    return rig_of(bench.rig, replace(hypothesis, values=bench.values_in(hypothesis, recording)))


def felt_in_each(rig_in: Callable[[str], Rig], experiments: Sequence[Experiment]) -> list[Experiment]:
    """As `felt_together`, where the machine differs from recording to recording.

    Args:
        rig_in: name of a recording -> the machine with the values of a fitted model.
        experiments: of one or more recordings.
    """
    felt: list[Experiment] = []
    for group in recordings_of(experiments):
        if group[0].others is None:
            felt += group
            continue
        rig = rig_in(group[0].name)
        own = [replace(e, index=rig.joints.index(e.joint)) for e in group]
        felt += [
            e if there is alone else replace(there, index=e.index)
            for e, alone, there in zip(group, own, _felt(rig, own), strict=True)
        ]
    return felt


def _felt(rig: Rig, group: Sequence[Experiment]) -> list[Experiment]:
    """The joints of one recording, beside each other."""
    begin, end = min(float(e.time[0]) for e in group), max(float(e.time[-1]) for e in group)
    times = begin + DATA.motion_step_s * np.arange(int((end - begin) / DATA.motion_step_s + 1e-6) + 2)
    records = rig.records()
    done = OneRecording(rig, group).roll_out(records, times)
    if done.diverged is not None:
        return list(group)
    motions, flows = {}, {}
    for i, joint in enumerate(done.joints):
        position, velocity = done.signals["position"][:, i], done.signals["velocity"][:, i]
        motions[joint] = (position, velocity, np.gradient(velocity, DATA.motion_step_s))
        flows[joint] = done.signals["drawn"][:, i]
    firsts = {e.joint: float(e.time[0]) - begin for e in group}
    probes = probes_of(rig, motions, flows, DATA.motion_step_s, firsts)
    felt = [replace(e, others=probes[e.joint]) for e in group]
    return [replace(e, others_error=_apart(e, records, done)) for e in felt]


def _apart(experiment: Experiment, records: np.ndarray, done: Together) -> np.ndarray:
    """By how much a joint's own rollout differs from that of all at the same values. # (channels, n)."""
    own = experiment.simulate(records).signals
    column = done.joints.index(experiment.joint)
    models = [channel.model for channel in experiment.channels]
    whole = [np.interp(experiment.time, done.time, done.signals[model][:, column]) for model in models]
    return np.array([getattr(own, model) for model in models]) - np.array(whole)


def least_over_noise(experiments: Sequence[Experiment]) -> float:
    """Times the noise that equations leave at best, as the rig's `model_error` says; behind a cut where there is one.

    That of joints which move together is not known: theirs is also what others do to each.

    Args:
        experiments: whose.
    """
    if any(e.others is not None for e in experiments):
        return 1.0  # what other joints do is no error of the equations
    behind = [e.behind_cut() for e in experiments]
    return math.sqrt(1.0 + sum(e.admitted for e in behind) / max(sum(e.counted for e in behind), 1))


def far_over_noise(experiments: Sequence[Experiment]) -> float:
    """Times the noise that a structure leaves which is far from what its equations leave at best.

    Its numbers are bent then by what it lacks; what leaves less leads on from where it was fitted.

    Args:
        experiments: whose.
    """
    return NOISE.far * least_over_noise(experiments)
