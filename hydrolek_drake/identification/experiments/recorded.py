"""Experiments of a recording: one for each joint that is driven in it."""

import math
from dataclasses import replace

import numpy as np

from hydrolek_drake.errors import UninformativeError
from hydrolek_drake.identification.experiments.channel import Channel, faithful, spanned
from hydrolek_drake.identification.experiments.experiment import Experiment
from hydrolek_drake.identification.experiments.neighbours import effects_of_others
from hydrolek_drake.identification.experiments.start import resting_position
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.noise import noise_level
from hydrolek_drake.replay.readings import driven_joints, measured_position, position_key
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import recorded_inputs, with_commands

CONSTANT = 1e-12
"""A command that varies by less than this fraction of its size says nothing about the machine."""


def experiments_of(
    rig: Rig,
    recording: Recording,
    signals: tuple[str, ...] = ("position", "pressure_a", "pressure_b", "supply_pressure", "current"),
) -> list[Experiment]:
    """One experiment for each joint of the rig that has a command in the recording.

    A recording that is sampled far faster than the rig is integrated is averaged over blocks (`thinning`).

    Args:
        rig: the machine.
        recording: read with the rig's `columns`.
        signals: which of position, pressure_a, pressure_b, supply_pressure, current are to be followed, where recorded;
            the supply's for a rig of one joint only, since all joints draw from it and a rollout knows one.

    Raises:
        InputError: no command, no position, a command that never changes, or a signal without noise level.
    """
    recording = with_commands(rig, recording)
    driven = driven_joints(rig, recording)
    if not driven:
        require(recording, [f"{rig.joints[0]}.command"])
    experiments = [_experiment(rig, joint, recording, signals).thinned() for joint in driven]
    others = effects_of_others(rig, {e.joint: _moved(rig, e, recording) for e in experiments})
    return [replace(e, others=others.get(e.joint)) for e in experiments]


def _moved(rig: Rig, experiment: Experiment, recording: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Times and measured positions of a joint."""
    for channel in experiment.channels:
        if channel.model == "reading":
            return experiment.time, channel.measured
    return recording.time, np.asarray(measured_position(rig, experiment.joint, recording), dtype=float)


def _experiment(rig: Rig, joint: str, recording: Recording, wanted: tuple[str, ...]) -> Experiment:
    key = f"{joint}.command"
    require(recording, [], complete=[key], units={key: "V"})
    command = np.asarray(recording.signal(key), dtype=float)
    if rig.needs_command(joint) and np.ptp(command) <= CONSTANT * max(float(np.abs(command).max()), 1.0):
        raise UninformativeError(
            f"{recording.source}: {key} is constant at {command[0]:g} V, so nothing can be identified; "
            "record the joint while its command changes"
        )
    channels = []
    place = position_key(rig, joint)
    position = np.asarray(measured_position(rig, joint, recording), dtype=float)
    if not np.isfinite(position).any():
        raise UninformativeError(f"{recording.source}: {place} has no value at all")
    if not _changes(position):
        raise UninformativeError(
            f"{recording.source}: {place} is constant, so nothing can be identified; is the sensor connected?"
        )
    if "position" in wanted:
        unit = "m" if place.endswith(".position") else "rad"
        noise = _noise(position, rig, joint, "noise")
        channels.append(Channel(place, unit, "reading", position, noise))
    if rig.is_hydraulic(joint):
        for quantity in ("pressure_a", "pressure_b"):
            name = f"{joint}.{quantity}"
            if quantity in wanted and name in recording.signals and name not in rig.driven_by:
                measured = np.asarray(recording.signal(name), dtype=float)
                noise = _noise(measured, rig, joint, "pressure_noise")
                channels.append(Channel(name, "Pa", quantity, measured, noise))
        followed = "supply.pressure" in recording.signals and "supply.pressure" not in rig.driven_by
        if "supply_pressure" in wanted and followed and len(rig.joints) == 1:
            measured = np.asarray(recording.signal("supply.pressure"), dtype=float)
            noise = _noise(measured, rig, joint, "pressure_noise")
            channels.append(Channel("supply.pressure", "Pa", "supply_pressure", measured, noise))
    name = f"{joint}.current"
    if rig.tells_current(joint) and "current" in wanted and name in recording.signals:
        measured = np.asarray(recording.signal(name), dtype=float)
        noise = _noise(measured, rig, joint, "current_noise")
        channels.append(Channel(name, "A", "current", measured, noise))
    share = rig.value("integration.model_error")
    start, start_error = None, 0.0
    if rig.initial_position == "recording":
        start, start_error = resting_position(position, command, _noise(position, rig, joint, "noise"))
    return Experiment(
        name=recording.name,
        joint=joint,
        index=rig.joints.index(joint),
        time=np.ascontiguousarray(recording.time, dtype=float),
        command_times=np.ascontiguousarray(recording.time, dtype=float),
        command=command,
        channels=tuple(
            replace(c, least_error=_least_error(c, share)).timed(
                recording.time, rig.value("integration.time_error")
            )
            for c in channels
            if _changes(c.measured)
        ),
        start=start,
        start_error=start_error,
        longest_step=rig.value("integration.longest_step"),
        spool_steps=int(rig.value("integration.spool_steps")),
        used=np.ones(recording.time.size, dtype=bool),
        recorded=recorded_inputs(rig, joint, recording),
    )


def _changes(measured: np.ndarray) -> bool:
    """Whether a signal shows anything: one that is constant has no noise that would weigh it, and is not followed."""
    told = measured[np.isfinite(measured)]
    return told.size > 0 and float(np.ptp(told)) > 0.0


def _least_error(channel: Channel, share: float) -> float:
    """What equations leave at best of a signal, less what its noise holds of that already.

    Args:
        channel: the signal.
        share: of its range.
    """
    told = noise_level(channel.measured)
    held = max(channel.noise**2 - told**2, 0.0) if channel.noise <= faithful(channel.measured) else 0.0
    return math.sqrt(max((share * spanned(channel.measured)) ** 2 - held, 0.0))


def _noise(measured: np.ndarray, rig: Rig, joint: str, name: str) -> float:
    """Noise of a channel from the recording itself, or from the rig if the recording shows none."""
    level = noise_level(measured) or rig.value(f"joints.{joint}.sensor.{name}")
    return max(level, faithful(measured), np.finfo(float).tiny)
