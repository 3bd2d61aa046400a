"""How much each measured value counts: weights from the noise and the model error that show beside a model."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hydrolek_drake.diagnosis.effort import ABOVE_NOISE, AT_NOISE, FAR, HOPELESS, LOOK, POLISH
from hydrolek_drake.diagnosis.found import Search
from hydrolek_drake.diagnosis.settling import settled_together
from hydrolek_drake.diagnosis.structures.as_rig import rig_of
from hydrolek_drake.diagnosis.structures.lost_windows import arrivals
from hydrolek_drake.diagnosis.together import felt_together
from hydrolek_drake.diagnosis.workbench import Hypothesis, Workbench
from hydrolek_drake.identification.channel import faithful
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.replay.noise import noise_level

OTHERS_UNKNOWN = 0.1
"""What other joints do to one is known to this share: their areas and masses are the rig's own, unfitted, and their
speeds come from smoothed angles."""

MOST_FOLLOWED = 5
"""So many models beside the best one are followed where joints move together."""

NEARER = 0.5
"""A model that leaves this share of what the one left by which the data are weighed tells their noise better."""


def weighted_by(
    bench: Workbench, hypothesis: Hypothesis, experiments: Sequence[Experiment]
) -> list[Experiment]:
    """The same experiments with noise, model error and response to the start as they show beside this model.

    A recorded signal's own movement passes for noise where it is fast; most of it is gone in the residual.
    The error of the integration is told from a second rollout with half the step: the method is of second
    order, so the coarser one is wrong by 4/3 of their difference. What joints that move at the same time do
    is told by rolling out all joints where the model is near the noise, and known to `OTHERS_UNKNOWN` elsewhere.
    """
    problem = bench.problem(hypothesis.effects, bench.fine, experiments)
    records = problem.parameters.records(problem.parameters.unit(hypothesis.values))
    if hypothesis.fit.over_noise < FAR and any(e.others is not None for e in experiments):
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
                error = np.hypot(error, OTHERS_UNKNOWN * (model - getattr(alone, channel.model)))
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


def settled(bench: Workbench, hypothesis: Hypothesis) -> Hypothesis:
    """A fit gone on with training data that are weighted by what it leaves, which are replaced.

    Near the noise, where joints move together, also with what they do to each other, see `settling`.

    Args:
        bench: fits, and the training data.
        hypothesis: fitted to these.
    """
    bench.training = tuple(weighted_by(bench, hypothesis, bench.training))
    near = hypothesis.fit.over_noise < FAR
    if not near or not bench.together:
        return bench.refit(hypothesis, bench.fine, POLISH if near else 1)
    fitted = bench.refit(hypothesis, bench.fine, 2 * LOOK)
    if fitted.fit.over_noise <= AT_NOISE and not fitted.effects:
        return fitted  # of which nobody asks the numbers
    return settled_together(bench, fitted)


def weigh_anew(bench: Workbench, found: Search) -> None:
    """Weigh the training data by the best model, and fit again with these weights what is near it.

    What a model far from the noise leaves moves fast, and some of it passes for noise. And what is known of other
    joints that move at the same time is a share of what they do: beside a model in which they do more, such as a supply
    that they share, more is unknown.
    """
    if not bench.together and found.best.fit.over_noise > NEARER * found.weighed_at:
        return
    if bench.together and not found.best.effects:
        return  # by which the data are weighed already
    if bench.together and found.best.fit.over_noise < FAR:
        best = _settled_or_anew(bench, found.best)
    else:
        best = found.best
        bench.training = tuple(weighted_by(bench, best, bench.training))
    _fit_again(bench, found, best)


def _settled_or_anew(bench: Workbench, hypothesis: Hypothesis) -> Hypothesis:
    """A fit settled, as it is or from the rig's own values; where one does not reach the noise also the other.

    The model without an effect bends its numbers to make up for it, and then tells the other joints' movement wrong:
    from there a fit with the first effect may settle far from where it should. The rig's own values, with what measured
    angles tell of the other joints, come first then; later ones begin beside effects that have straightened them.
    """
    so_far = bench.training

    def as_it_is() -> Hypothesis:
        bench.training = so_far
        return settled(bench, hypothesis)

    def anew() -> Hypothesis:
        bench.training = bench.recorded
        own = {path: value for path, value in hypothesis.values.items() if ".effects." in path}
        return settled(bench, bench.fit(hypothesis.effects, own, bench.fine, 2 * LOOK))

    ended: list[tuple[Hypothesis, tuple[Experiment, ...]]] = []
    for begin in (anew, as_it_is) if len(hypothesis.effects) == 1 else (as_it_is, anew):
        ended.append((begin(), bench.training))
        if ended[-1][0].fit.over_noise <= ABOVE_NOISE:
            break
    best, bench.training = min(ended, key=lambda end: end[0].fit.over_noise)
    return best


def _fit_again(bench: Workbench, found: Search, best: Hypothesis) -> None:
    """Fit again what is near the best model, and give up the rest.

    Where joints move together every effect is a candidate at each of them, and only the best few are followed.
    """
    bound = HOPELESS * found.best.fit.objective
    ranked = sorted(found.hypotheses.values(), key=lambda h: h.fit.objective)
    near = [h for h in ranked if h.ids != best.ids and h.fit.objective < bound]
    near = [best, *near[: MOST_FOLLOWED if bench.together else None]]
    chosen = {h.ids: h for h in (found.baseline, *near)}
    again = bench.side_by_side(
        lambda h: bench.refit(h, bench.fine, POLISH if h.fit.over_noise < FAR else 1), list(chosen.values())
    )
    found.given_up.update(found.hypotheses)
    found.hypotheses.clear()
    for fitted in again:
        found.keep(fitted)
    found.weighed_at = found.best.fit.over_noise
