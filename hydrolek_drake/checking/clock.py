"""Times of a recording that can be no seconds: told before anything is computed with them."""

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording
from hydrolek_drake.rigs import Rig

SLOWEST_SAMPLING = 2.0
"""A machine is sampled more often than this [s]: in ms it would be two thousand of them."""

SHORTEST = 0.2
"""A recording lasts longer than this [s]: of the shortest that tell anything, in ms it would be below."""


def refuse_other_clock(rig: Rig, recording: Recording) -> None:
    """Refuse a recording whose times can be no seconds, before it is computed with.

    Raises:
        InputError: sampled every few seconds or lasting no quarter of one, with the line that mends it.
    """
    step = float(np.median(np.diff(recording.time)))
    if step > SLOWEST_SAMPLING and any(f"{joint}.command" in recording.signals for joint in rig.joints):
        raise InputError(
            f"{recording.source}: time: samples {step:g} s apart and {recording.duration:.4g} s in all are no "
            "recording of a machine that moves: ms in a column of s? in the rig: "
            "recording: {columns: {time_s: time_ms}}"
        )
    if recording.duration < SHORTEST and recording.time.size > 50:
        raise InputError(
            f"{recording.source}: time: {recording.time.size} samples within {recording.duration:.3g} s are no "
            "recording of a machine that moves: s in a column of ms? in the rig: "
            "recording: {columns: {time_ms: time_s}}"
        )
