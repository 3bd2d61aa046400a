"""What of a recording drives a rig's model in place of a part of it, as inputs of a rollout."""

from dataclasses import replace

import numpy as np

from hydrolek_drake.physics.driven import INPUTS
from hydrolek_drake.physics.probes import PROBES
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.recordings.clock import JITTER_FRACTION
from hydrolek_drake.rigs.machine.driven_by import signals_of
from hydrolek_drake.rigs.machine.rig import Rig

Inputs = tuple[float, np.ndarray]
"""Spacing of samples [s], and `probes.PROBES` at each of them. # (k, 15)."""

_FINER = 4
"""Samples of inputs have one spacing; of a recording whose clock jitters there are so many for each of its own."""


def all_recorded_inputs(rig: Rig, recording: Recording) -> dict[str, Inputs]:
    """The recorded signals that drive joints, by joint; see `recorded_inputs`."""
    found = {joint: recorded_inputs(rig, joint, recording) for joint in rig.joints}
    return {joint: inputs for joint, inputs in found.items() if inputs is not None}


def recorded_inputs(rig: Rig, joint: str, recording: Recording) -> Inputs | None:
    """The recorded signals that drive a joint, on straight lines between their samples.

    Args:
        rig: the machine.
        joint: its name.
        recording: whose first sample the rollout begins with.

    Returns:
        Spacing [s] and rows of `probes.PROBES`, # (k, 15), as of `rollout.roll_out`; None where nothing drives the
        joint.

    Raises:
        InputError: the recording lacks such a signal, or a value of it.
    """
    places = {
        key: place
        for part, keys in signals_of(rig.driven_by, joint).items()
        for key, place in zip(keys, INPUTS[part], strict=True)
    }
    driving = list(places)
    if not driving:
        return None
    require(recording, [], complete=driving)
    steps = np.diff(recording.time)
    even = np.ptp(steps) <= JITTER_FRACTION * 0.01 * np.median(steps)
    count = recording.time.size if even else round(_FINER * recording.duration / float(np.median(steps))) + 1
    at = np.linspace(recording.time[0], recording.time[-1], max(count, 2))
    rows = np.zeros((at.size, len(PROBES)))
    for key in driving:
        rows[:, places[key]] = np.interp(at, recording.time, recording.signal(key))
    return float(at[1] - at[0]), rows


def with_commands(rig: Rig, recording: Recording) -> Recording:
    """The recording, with a neutral command for joints that a recorded spool or chambers drive and that lack one."""
    signals, units = dict(recording.signals), dict(recording.units)
    for joint in rig.joints:
        key = f"{joint}.command"
        if key not in signals and not rig.needs_command(joint):
            neutral = rig.value(f"joints.{joint}.command.neutral")
            signals[key], units[key] = np.full(recording.time.size, neutral), "V"
    if len(signals) == len(recording.signals):
        return recording
    return replace(recording, signals=signals, units=units)
