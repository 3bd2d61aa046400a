"""Which data are fitted, which are held out to decide, and which cannot be diagnosed at all: these are refused."""

from collections.abc import Sequence

import numpy as np

from hydrolek_drake.diagnosis.settings import DATA
from hydrolek_drake.errors import InputError, UninformativeError
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.recorded import experiments_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig


def prepared(
    rig: Rig,
    recordings: Sequence[Recording],
    holdout: Sequence[Recording],
    between: tuple[float, float] | None,
) -> tuple[tuple[Experiment, ...], tuple[Experiment, ...], list[str]]:
    """Training data, held-out data, and reasons against them."""
    sets: list[list[Experiment]] = []
    reasons: list[str] = []
    for group in (recordings, holdout):
        experiments: list[Experiment] = []
        for recording in group:
            try:
                own = experiments_of(rig, recording)
            except UninformativeError as error:
                reasons.append(str(error))
                continue
            reasons += reasons_against(recording, own)
            experiments += own
        sets.append(experiments)
    training, held_out = sets
    if training and not held_out and not reasons:
        held = [_held_blocks(e) if between is None else ~_within(e, between) for e in training]
        held_out = [e.split(e.used & h) for e, h in zip(training, held, strict=True)]
        training = [e.split(e.used & ~h) for e, h in zip(training, held, strict=True)]
    elif between is not None:
        training = [e.split(e.used & _within(e, between)) for e in training]
    return tuple(training), tuple(held_out), reasons


def _within(experiment: Experiment, between: tuple[float, float]) -> np.ndarray:
    """Samples of the part that is fitted. # (n,).

    Raises:
        InputError: there is none, or the recording has nothing else.
    """
    start, end = between
    inside = (experiment.time >= start) & (experiment.time <= end)
    if not start < end or not inside.any() or inside.all():
        first, last = experiment.time[[0, -1]]
        raise InputError(
            f"--between {start:g} {end:g}: must be a part of recording {experiment.name} and leave another part of "
            f"it; it has samples from {first:g} to {last:g} s"
        )
    return inside


def _held_blocks(experiment: Experiment) -> np.ndarray:
    """Samples of the blocks that are held out. # (n,)."""
    block = np.floor(DATA.blocks * np.arange(experiment.time.size) / experiment.time.size)
    return block % DATA.held_every == DATA.held_every - 1


def short_blocks(experiment: Experiment) -> np.ndarray:
    """In which of `DATA.short_blocks` each sample that counts lies. # (n,)."""
    so_far = np.cumsum(experiment.used) - 1
    count = max(int(experiment.used.sum()), 1)
    return np.asarray(np.floor(DATA.short_blocks * np.maximum(so_far, 0) / count).astype(int))


def halves(held_out: Sequence[Experiment]) -> tuple[tuple[Experiment, ...], tuple[Experiment, ...]]:
    """Held-out data in two parts: blocks by which structures are chosen, and those between, which only report.

    What chose among many is no longer an independent test of the one that was chosen.
    """
    chosen = tuple(e.split(e.used & (short_blocks(e) % 2 == 0)) for e in held_out)
    kept = tuple(e.split(e.used & (short_blocks(e) % 2 == 1)) for e in held_out)
    return chosen, kept


def mixed(
    training: Sequence[Experiment], held_out: Sequence[Experiment]
) -> tuple[tuple[Experiment, ...], tuple[Experiment, ...], tuple[Experiment, ...]]:
    """Two thirds of the held-out data for training too; of the rest, what chooses, and what reports as in `halves`."""
    blocks = [short_blocks(e) for e in held_out]
    fitted = [e.split(e.used & (b % 3 != 2)) for e, b in zip(held_out, blocks, strict=True)]
    chosen = [e.split(e.used & (b % 6 == 2)) for e, b in zip(held_out, blocks, strict=True)]
    kept = [e.split(e.used & (b % 6 == 5)) for e, b in zip(held_out, blocks, strict=True)]
    return (*training, *fitted), tuple(chosen), tuple(kept)


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
