"""Whether recordings can carry a diagnosis at all; what cannot is said, never diagnosed."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.recordings import Recording

LEAST_SAMPLES = 200
"""Fewer samples than this cannot decide between some twenty effects and ten nominal parameters."""

LEAST_TRAVEL = 20.0
"""The joint must move by this many times the noise, or there is no movement to explain."""

MOST_MISSING = 0.3
"""Share of missing values above which a signal is no measurement of the whole recording."""

MOST_SATURATED = 0.2
"""Share of the time at a sensor's limit above which the signal does not show the movement."""

FROZEN_SPAN_S = 1.0
"""A sensor that repeats one value for so long while the command drives the joint may have frozen."""

MOST_FROZEN = 0.25
"""Share of the time with a frozen sensor above which the recording is unusable."""


def reasons_against(recording: Recording, experiments: Sequence[Experiment]) -> list[str]:
    """Why a recording cannot be diagnosed, one sentence each; empty if it can.

    Args:
        recording: as read.
        experiments: its joints.
    """
    reasons = []
    if recording.time.size < LEAST_SAMPLES:
        reasons.append(
            f"{recording.name} has {recording.time.size} samples; at least {LEAST_SAMPLES} are needed"
        )
    gaps = sum(end - start for f in recording.findings if f.kind == "gap" for start, end in f.spans)
    if gaps > MOST_MISSING * recording.duration:
        reasons.append(
            f"{recording.name}: nothing was recorded for {gaps:.1f} s of {recording.duration:.1f} s, "
            "so what the machine was told meanwhile is not known"
        )
    for experiment in experiments:
        position = experiment.channels[0]
        known = np.isfinite(position.measured)
        missing = 1.0 - float(known.mean())
        if missing > MOST_MISSING:
            reasons.append(
                f"{recording.name}: {position.key} has no value in {100 * missing:.0f} % of the samples"
            )
        travel = float(np.nanmax(position.measured) - np.nanmin(position.measured)) if known.any() else 0.0
        if travel < LEAST_TRAVEL * position.noise:
            reasons.append(
                f"{recording.name}: {position.key} hardly moves ({travel:.3g} {position.unit}, "
                f"noise {position.noise:.2g}), so there is no movement to explain"
            )
        saturated = _share(recording, position.key, "saturated")
        if saturated > MOST_SATURATED:
            reasons.append(
                f"{recording.name}: {position.key} sits at its limit for {100 * saturated:.0f} % of the time"
            )
        frozen = _frozen_share(experiment)
        if frozen > MOST_FROZEN:
            reasons.append(
                f"{recording.name}: {position.key} repeats one value for {100 * frozen:.0f} % of the time "
                "without any noise, as a sensor does that has frozen"
            )
    return reasons


def _share(recording: Recording, key: str, kind: str) -> float:
    spans = [s for f in recording.findings if f.kind == kind and f.signal == key for s in f.spans]
    return sum(end - start for start, end in spans) / recording.duration


def _frozen_share(experiment: Experiment) -> float:
    """Share of the time in long runs of one value, of a signal that is noisy elsewhere."""
    values, time = experiment.channels[0].measured, experiment.time
    same = np.diff(values) == 0.0
    if same.mean() > 0.9 or experiment.channels[0].noise <= 0.0:
        return (
            float(same.mean()) if same.mean() > 0.98 else 0.0
        )  # a coarse or noise-free signal repeats itself
    edges = np.flatnonzero(np.diff(np.concatenate([[False], same, [False]]).astype(int)))
    spans = [time[end] - time[begin] for begin, end in zip(edges[::2], edges[1::2], strict=True)]
    return float(sum(span for span in spans if span > FROZEN_SPAN_S)) / float(np.ptp(time))
