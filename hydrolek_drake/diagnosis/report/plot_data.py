"""What the plots of the page draw, as data for its script: every sample of short recordings, the peaks of long ones."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from hydrolek_drake.diagnosis.diagnosis import Diagnosis
from hydrolek_drake.diagnosis.locating.unknown_input import Estimate
from hydrolek_drake.diagnosis.report.arm_data import arm_data
from hydrolek_drake.diagnosis.report.fading import SHARES, Fading, fadings
from hydrolek_drake.diagnosis.report.packing import packed
from hydrolek_drake.diagnosis.report.panels import (
    after,
    before,
    held_out_spans,
    partly_fitted,
    shown_experiments,
)
from hydrolek_drake.identification.experiments.channel import Channel
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.replay.display import display_factor, display_unit
from hydrolek_drake.replay.spans import BEYOND_NOISE
from hydrolek_drake.rollout.rollout import Signals

MOST_NUMBERS = 420_000
"""Of all plots: with four bytes each in base 64 they take 2.3 of the 3 MB that a page may have."""

MOST_POINTS = 5000
"""Of one plot: more than a screen has columns."""

MOST_FADED = 4
"""So many things can be faded at most: all that was found, and the first ones by themselves."""

KEPT = 2
"""Of each group of samples the smallest and the largest value of each signal that is looked at are kept."""


def plot_data(diagnosis: Diagnosis) -> dict[str, Any]:
    """All that the script draws.

    Args:
        diagnosis: with a bench.

    Returns:
        `shares`, `fadings` (name, title), `recordings` (`recording_data`) and `arm` (`arm_data`, or None).
    """
    shown = shown_experiments(diagnosis)
    faded = fadings(diagnosis)[:MOST_FADED]
    per_point = sum(len(e.channels) * (3 + len(SHARES) * max(len(faded), 1)) for e in shown)
    points = min(MOST_POINTS, MOST_NUMBERS // per_point)
    return {
        "shares": SHARES.tolist(),
        "fadings": [{"name": each.name, "title": each.title} for each in faded],
        "recordings": [recording_data(diagnosis, each, faded, points) for each in shown],
        "arm": arm_data(diagnosis, shown),
    }


def recording_data(
    diagnosis: Diagnosis, experiment: Experiment, faded: Sequence[Fading], points: int
) -> dict[str, Any]:
    """One recording: a chart for each signal, the command, and the unknown inputs where they were estimated on it.

    Args:
        diagnosis: with a bench.
        experiment: one joint's part of a recording.
        faded: what can be faded.
        points: of each chart at most.

    Returns:
        Times in s, signals in the units that people use; each array as `packed`.
    """
    assert diagnosis.bench is not None
    fitted = any(experiment is e for e in diagnosis.bench.training)
    without, enlarged = before(diagnosis, experiment), after(diagnosis, experiment)
    courses = [each.signals(experiment) for each in faded]
    unfitted = not fitted and not partly_fitted(diagnosis, experiment)
    spans = [] if unfitted else held_spans_of(diagnosis, experiment)
    what = "held out" if unfitted else "fitted, but for the shaded blocks" if spans else "fitted"
    grown = diagnosis.locations[0].when if fitted and diagnosis.locations else ()
    first = experiment is diagnosis.bench.training[0]
    step = slice(None, None, -(-experiment.command.size // points))
    return {
        "title": f"{experiment.name}, {experiment.joint}: {what}",
        "held": spans,
        "grown": [list(span) for span in grown],
        "begin": float(experiment.time[0]),
        "end": float(experiment.time[-1]),
        "charts": [
            chart_data(experiment, channel, without, enlarged, courses, points)
            for channel in experiment.channels
        ],
        "command": {
            "x": packed(experiment.command_times[step]),
            "y": packed(experiment.command[step]),
        },
        "unknown": [unknown_data(each) for each in diagnosis.estimates] if first else [],
    }


def held_spans_of(diagnosis: Diagnosis, experiment: Experiment) -> list[list[float]]:
    """Stretches of a recording that are held out [s]: its own, or those of the held-out part of a fitted one."""
    same = [
        held
        for held in diagnosis.held_out
        if held.joint == experiment.joint
        and np.array_equal(held.channels[0].measured, experiment.channels[0].measured, equal_nan=True)
    ]
    return [list(span) for held in same[:1] for span in held_out_spans(held)]


def chart_data(
    experiment: Experiment,
    channel: Channel,
    without: Signals,
    enlarged: Signals,
    courses: Sequence[Sequence[Signals]],
    points: int,
) -> dict[str, Any]:
    """One signal: measured, by the nominal model, and with what was found at each share of it.

    Args:
        experiment: the recording.
        channel: the signal.
        without: of the nominal model.
        enlarged: with all that was found.
        courses: of each thing that can be faded, at each share.
        points: at most.
    """
    factor = display_factor(channel.unit)
    old, new = getattr(without, channel.model), getattr(enlarged, channel.model)
    looked_at = (channel.measured, channel.measured - old, channel.measured - new)
    kept = samples_kept(looked_at, points)
    return {
        "name": channel.key,
        "unit": display_unit(channel.unit),
        "band": BEYOND_NOISE * factor * channel.noise,
        "every": -(-experiment.time.size // max(kept.size, 1)),
        "x": packed(experiment.time[kept]),
        "measured": packed(factor * channel.measured[kept]),
        "before": packed(factor * old[kept]),
        "after": packed(factor * new[kept]),
        "faded": [[packed(factor * getattr(s, channel.model)[kept]) for s in course] for course in courses],
    }


def unknown_data(estimate: Estimate) -> dict[str, Any]:
    """The course of an unknown input in the first recording, with two standard deviations."""
    times = estimate.unknown.times
    first = slice(0, int(np.argmax(np.diff(times, append=-np.inf) < 0.0)) + 1)
    given = estimate.unknown.input
    factor = display_factor(given.unit)
    return {
        "stage": given.stage,
        "name": given.symbol,
        "unit": display_unit(given.unit),
        "x": packed(times[first]),
        "y": packed(factor * estimate.course[first]),
        "wide": packed(2.0 * factor * estimate.deviation[first]),
    }


def samples_kept(signals: Sequence[np.ndarray], points: int) -> np.ndarray:
    """Indices of samples so that of each group of neighbours every signal keeps its smallest and largest value.

    Args:
        signals: NaN where there is none. # (n,) each
        points: as many as are kept at most (a few more where a group has none).

    Returns:
        In order; all of them where there are no more than `points`. # (k,)
    """
    count = signals[0].size
    if count <= points:
        return np.arange(count)
    size = -(-count * KEPT * len(signals) // points)
    starts = np.arange(0, count, size)
    kept: set[int] = {0, count - 1}
    for values in signals:
        low = np.where(np.isnan(values), np.inf, values)
        high = np.where(np.isnan(values), -np.inf, values)
        for start in starts.tolist():
            group = slice(start, start + size)
            kept |= {start + int(low[group].argmin()), start + int(high[group].argmax())}
    return np.array(sorted(kept))
