"""A rig's model driven by a recorded command."""

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.display import shown
from hydrolek_drake.replay.driving import Driven, Moved, moved
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import (
    Pair,
    driven_joints,
    measured_position,
    pairs_of_joint,
    position_key,
    supply_pair,
)
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import all_recorded_inputs, with_commands

START_SAMPLES = 5
"""Samples of the recorded position whose median is the start; odd, so that the median is a sample."""

CLEARLY = 5.0
"""A difference of this many times the noise is said, since noise alone never makes it."""


@dataclass(frozen=True)
class Replay:
    """What the model did under the recorded command, beside the recording.

    Attributes:
        rig: with the values that were used.
        recording: cut to the window that was replayed.
        commands: joint -> recorded command [V]. # (n,) each
        outcomes: joint -> what its model did, at the times of the recording.
        pairs: what can be compared, positions first.
        notes: one sentence each about how far the replay can be trusted.
        seconds: how long the rollouts took.
    """

    rig: Rig
    recording: Recording
    commands: dict[str, np.ndarray]
    outcomes: dict[str, Moved]
    pairs: tuple[Pair, ...]
    notes: tuple[str, ...]
    seconds: float


def replay(
    rig: Rig,
    recording: Recording,
    between: tuple[float, float] | None = None,
    by: Callable[..., dict[str, Moved]] = moved,
) -> Replay:
    """Drive every joint of the rig that has a command in the recording.

    Joints that share the pump or an arm run together, every other one on its own, from rest in balance, with recorded
    commands held between samples. An arm's joint without a command gives way on its oil, from where it was recorded.
    The clock of effects starts at the first sample that is replayed.

    Args:
        rig: the machine.
        recording: read with the rig's `columns`.
        between: start and end [s] in the recording's own time; None for all of it. Commands before the
            start still act, as far as the transport delay reaches.
        by: what drives the joints: the compiled rollout (`driving.moved`), or the Drake Diagram
            (`by_diagram.moved_by_diagram`).

    Raises:
        InputError: no command for any joint, a command without a value, no position to compare with, or a
            window that holds fewer than two samples.
    """
    if between is not None and not between[0] < between[1]:
        raise InputError(f"--between {between[0]:g} {between[1]:g}: the start must lie before the end")
    window = recording if between is None else recording.between(*between)
    cut = bool(window.time[0] > recording.time[0])
    recording, window = with_commands(rig, recording), with_commands(rig, window)
    driven = driven_joints(rig, recording)
    if not driven:
        require(recording, [f"{rig.joints[0]}.command"])
    missing = [joint for joint in rig.joints if joint not in driven]
    notes = [f"without a command in the recording, left out: {', '.join(missing)}"] if missing else []
    begun = clock.perf_counter()
    commands: dict[str, np.ndarray] = {}
    under: list[Driven] = []
    for joint in driven:
        key = f"{joint}.command"
        require(window, [], complete=[key], units={key: "V"})
        measured = measured_position(rig, joint, window)
        start, said = _start(rig, joint, window.time, measured, cut)
        notes += said
        until = _command_until(recording, key, window.time[0], window.time[-1])
        under.append(Driven(joint, *until, start))
        commands[joint] = window.signal(key)
    outcomes = by(rig, under, window.time, _elsewhere(rig, window, driven), all_recorded_inputs(rig, window))
    pairs: list[Pair] = []
    for joint, outcome in outcomes.items():
        if outcome.diverged:
            notes.append(f"the model of {joint} {outcome.diverged}; it is compared up to there")
        pairs += pairs_of_joint(rig, joint, window, outcome.signals)
    supply = supply_pair(rig, window, {joint: outcome.signals for joint, outcome in outcomes.items()})
    return Replay(
        rig=rig,
        recording=window,
        commands=commands,
        outcomes=outcomes,
        pairs=(*pairs, supply) if supply else tuple(pairs),
        notes=tuple(notes),
        seconds=clock.perf_counter() - begun,
    )


def _first_samples(measured: np.ndarray) -> np.ndarray:
    """Indices of the first `START_SAMPLES` that have a value, fewer if there are no more."""
    return np.flatnonzero(np.isfinite(measured))[:START_SAMPLES]


def _elsewhere(rig: Rig, window: Recording, driven: Sequence[str]) -> dict[str, float]:
    """Joints without a command -> recorded position [rad or m] at the beginning, of those that have one."""
    found = {}
    for joint in rig.joints:
        if joint not in driven and position_key(rig, joint) in window.signals:
            measured = measured_position(rig, joint, window)
            first = _first_samples(measured)
            if first.size:
                found[joint] = float(np.median(measured[first]))
    return found


def _command_until(recording: Recording, key: str, start: float, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Times and values of the command up to `end`, from after the last missing value before `start`."""
    values = recording.signal(key)
    missing = np.flatnonzero(np.isnan(values) & (recording.time < start))
    first = int(missing[-1]) + 1 if missing.size else 0
    last = int(np.searchsorted(recording.time, end, side="right"))
    return recording.time[first:last], values[first:last]


def _start(
    rig: Rig, joint: str, time: np.ndarray, measured: np.ndarray, cut: bool
) -> tuple[float | None, list[str]]:
    """Where the rollout starts (None: where the rig says), and what has to be said about it."""
    finite = _first_samples(measured)
    if not finite.size:
        raise InputError(f"{position_key(rig, joint)} has no value in the part that is to be replayed")
    recorded = float(np.median(measured[finite]))
    unit = "m" if rig.variant(joint, "load") == "sliding" else "rad"
    notes = []
    noise = noise_level(measured)
    if finite.size > 1:
        moved = abs(measured[finite[-1]] - measured[finite[0]])
        if cut and moved > CLEARLY * noise:
            rate = moved / (time[finite[-1]] - time[finite[0]])
            notes.append(
                f"{joint} moves at {shown(rate, unit)}/s where the window begins, but the model starts at "
                "rest; begin where the joint stands still"
            )
    if rig.initial_position == "recording" or cut:
        return recorded, notes
    stated = rig.value(f"joints.{joint}.load.initial_position")
    if abs(recorded - stated) > CLEARLY * noise:
        notes.append(
            f"{joint} starts at {shown(recorded, unit)} in the recording but at {shown(stated, unit)} in the "
            "rig, where the model starts; 'recording: {initial_position: recording}' in the rig changes that"
        )
    return None, notes
