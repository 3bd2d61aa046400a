"""Whether recordings can carry a diagnosis at all; what cannot is said, never diagnosed."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.settings import DATA
from hydrolek_drake.identification.experiment import Experiment
from hydrolek_drake.recordings import Recording


def reasons_against(recording: Recording, experiments: Sequence[Experiment]) -> list[str]:
    """Why a recording cannot be diagnosed, one sentence each; empty if it can.

    Args:
        recording: as read.
        experiments: its joints.
    """
    reasons = []
    if recording.time.size < DATA.least_samples:
        reasons.append(
            f"{recording.name} has {recording.time.size} samples; at least {DATA.least_samples} are needed"
        )
    gaps = sum(end - start for f in recording.findings if f.kind == "gap" for start, end in f.spans)
    if gaps > DATA.most_missing * recording.duration:
        reasons.append(
            f"{recording.name}: nothing was recorded for {gaps:.1f} s of {recording.duration:.1f} s, "
            "so what the machine was told meanwhile is not known"
        )
    for experiment in experiments:
        position = experiment.channels[0]
        known = np.isfinite(position.measured)
        missing = 1.0 - float(known.mean())
        if missing > DATA.most_missing:
            reasons.append(
                f"{recording.name}: {position.key} has no value in {100 * missing:.0f} % of the samples"
            )
        travel = float(np.nanmax(position.measured) - np.nanmin(position.measured)) if known.any() else 0.0
        if travel < DATA.least_travel * position.noise:
            reasons.append(
                f"{recording.name}: {position.key} hardly moves ({travel:.3g} {position.unit}, "
                f"noise {position.noise:.2g}), so there is no movement to explain"
            )
        saturated = _share(recording, position.key, "saturated")
        if saturated > DATA.most_saturated:
            reasons.append(
                f"{recording.name}: {position.key} sits at its limit for {100 * saturated:.0f} % of the time"
            )
        frozen = _frozen_share(experiment)
        if frozen > DATA.most_frozen:
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
    return float(sum(span for span in spans if span > DATA.frozen_span_s)) / float(np.ptp(time))
