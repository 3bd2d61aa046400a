"""Where the missing physics acts: stage, joint, time and condition.

A position integrates what goes wrong, so its error is large long after the cause has gone. What counts is
therefore where the difference between the model with and without the effect grows.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.diagnosis.structures.hypothesis import Hypothesis
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.least_squares.least_squares import Fit
from hydrolek_drake.replay.conditions import conditions_of, growth, shares
from hydrolek_drake.replay.noise import samples_in, smoothed
from hydrolek_drake.replay.spans import SMOOTHING_S, worst_spans
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rollout.rollout import Signals

LOW_PRESSURE = 0.15
"""Below this fraction of the supply pressure a chamber's pressure is low."""

HIGH_FLOW = 0.6
"""Above this fraction of its largest speed in the recording a joint demands much flow."""

LATE = 0.5
"""The second half of a recording is late in it."""

SLOW = 0.1
"""Below this fraction of its largest speed a joint is slow."""


@dataclass(frozen=True)
class Location:
    """Where a mismatch is.

    Attributes:
        stage: of the chain.
        joint: the joint.
        share: of the mismatch that is left by the nominal model.
        when: start and end of the stretches where it grows most [s].
        condition: in plain words.
    """

    stage: str
    joint: str
    share: float
    when: tuple[tuple[float, float], ...]
    condition: str


def conditions_for(rig: Rig, experiment: Experiment, signals: Signals) -> dict[str, np.ndarray]:
    """Condition in words -> when it holds; those of a replay, and those of the hydraulics. # (n,) each."""
    holds = conditions_of(rig, experiment.joint, experiment.command_at_samples, signals)
    speed = np.abs(np.nan_to_num(signals.velocity))
    fastest = float(speed.max()) or 1.0
    holds["while the joint is slow"] = (speed < SLOW * fastest) & ~holds["at rest"]
    holds["at high flow demand"] = speed > HIGH_FLOW * fastest
    if rig.is_hydraulic(experiment.joint):
        bound = LOW_PRESSURE * rig.value("supply.pressure")
        holds["at low pressure on side A"] = signals.pressure_a < bound
        holds["at low pressure on side B"] = signals.pressure_b < bound
    begin, end = experiment.time[0], experiment.time[-1]
    holds["late in the recording"] = experiment.time > begin + LATE * (end - begin)
    return holds


def told_condition(time: np.ndarray, difference: np.ndarray, holds: dict[str, np.ndarray]) -> str:
    """The condition in which a difference grows most, in words."""
    found = shares(time, growth(time, difference), holds)
    found = tuple(c for c in found if 0.0 < c.of_time < 1.0)
    if not found or found[0].excess < 0.1:
        return "all the time, in no particular condition"
    first = found[0]
    return (
        f"{first.name} (where {100 * first.of_error:.0f} % of the change in the error arises, in "
        f"{100 * first.of_time:.0f} % of the time)"
    )


def growing_spans(time: np.ndarray, difference: np.ndarray, noise: float) -> tuple[tuple[float, float], ...]:
    """Where a difference grows most, in the order of time [s]."""
    width = samples_in(SMOOTHING_S, time)
    spans = worst_spans(time, growth(time, smoothed(difference, width)), noise)
    return tuple(sorted((span.start, span.end) for span in spans))


def share_of(baseline: Fit, taken: float) -> float:
    """Which share of what the nominal model leaves above the noise something takes, 0 to 1.

    Args:
        baseline: the fitted nominal model; it may leave less than the noise where the noise is told too high.
        taken: fall of the squared residuals.
    """
    return taken / max(baseline.chi_squared - baseline.counted, taken) if taken > 0.0 else 0.0


def locate(
    bench: Workbench, best: Hypothesis, baseline: Hypothesis, experiments: tuple[Experiment, ...]
) -> tuple[Location, ...]:
    """One location for each effect of the best model, the largest share first.

    Args:
        bench: fits.
        best: the model with effects.
        baseline: the nominal model, refitted.
        experiments: the training data.
    """
    explained = share_of(baseline.fit, baseline.fit.chi_squared - best.fit.chi_squared)
    found = []
    weights = []
    for candidate in best.listed:
        neutral = {
            f"joints.{candidate.joint}.effects.{candidate.id}.{p.name}": float(p.neutral or 0.0)
            for p in candidate.effect.parameters
        }
        rig = bench.rig.with_values(best.values)
        without = rig.with_values(neutral)
        shown = [_difference(e, rig, without) for e in experiments]
        experiment, present, difference = max(shown, key=lambda s: _weight(s[0], s[2]))
        channel = experiment.channels[0]
        weights.append(_weight(experiment, difference))
        holds = conditions_for(rig, experiment, present)
        found.append(
            Location(
                stage=candidate.effect.stage,
                joint=experiment.joint,
                share=0.0,
                when=growing_spans(experiment.time, difference, channel.noise),
                condition=told_condition(experiment.time, difference, holds),
            )
        )
    shares_ = [explained * weight / sum(weights) for weight in weights]
    located = [
        Location(place.stage, place.joint, float(share), place.when, place.condition)
        for place, share in zip(found, shares_, strict=True)
    ]
    return tuple(sorted(located, key=lambda place: -place.share))


def left_at(joint: str, residuals: np.ndarray, experiments: Sequence[Experiment]) -> tuple[float, int]:
    """Squared residuals of a joint's own signals, and how many values count there.

    Args:
        joint: its name.
        residuals: of all experiments, in units of the noise. # (values,)
        experiments: in their order.
    """
    place, squares, counted = 0, 0.0, 0
    for experiment in experiments:
        size = len(experiment.channels) * experiment.time.size
        if experiment.joint == joint:
            own = residuals[place : place + size]
            squares, counted = squares + float(own @ own), counted + experiment.counted
        place += size
    return squares, counted


def _difference(experiment: Experiment, rig: Rig, without: Rig) -> tuple[Experiment, Signals, np.ndarray]:
    """An experiment, what the model does with an effect, and by how much its reading is another without it."""
    present = experiment.simulate(rig.records()).signals
    absent = experiment.simulate(without.records()).signals
    return experiment, present, present.reading - absent.reading


def _weight(experiment: Experiment, difference: np.ndarray) -> float:
    return float(np.nanmean((difference / experiment.channels[0].noise) ** 2))
