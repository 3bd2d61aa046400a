"""Samples as a source brings them, and as the observer takes them: in SI, joint by joint."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.replay.readings import measured_position
from hydrolek_drake.rigs import Rig
from hydrolek_drake.rigs.machine.recorded_inputs import with_commands
from hydrolek_drake.rollout.kernel import PULLED

COLUMNS = ("command", *PULLED)
"""What is known of a joint at a moment: command [V], position [rad or m], pressures [Pa]."""


@dataclass(frozen=True)
class Samples:
    """Some samples of one source, in the order in which they came.

    Attributes:
        time: by the sender's clock [s], not yet checked. # (n,)
        signals: by `<joint>.<quantity>`, in SI; NaN for no value. # (n,) each
        units: SI unit of each signal.
        begins: a new recording or connection begins with them, whose clock need not go on from the last one's.
        source: what they come from, for messages.
    """

    time: np.ndarray
    signals: Mapping[str, np.ndarray]
    units: Mapping[str, str] = field(default_factory=dict)
    begins: bool = False
    source: str = "stream"

    def parts(self, count: int) -> Iterator["Samples"]:
        """The same in parts of so many samples at most."""
        for first in range(0, self.time.size, count):
            part = slice(first, first + count)
            signals = {key: values[part] for key, values in self.signals.items()}
            yield replace(self, time=self.time[part], signals=signals, begins=self.begins and first == 0)

    @staticmethod
    def of(recording: Recording, begins: bool = True) -> "Samples":
        """Those of a recording."""
        return Samples(recording.time, recording.signals, recording.units, begins, str(recording.source))


def by_joint(rig: Rig, joints: Sequence[str], samples: Samples) -> np.ndarray:
    """Samples as the observer takes them; a potentiometer's volts are converted as in a recording.

    Args:
        rig: the machine.
        joints: that are observed.
        samples: in any order of time.

    Returns:
        `COLUMNS` of each joint, NaN where there is no value. # (n, joints, 4)

    Raises:
        InputError: a joint has no command or no position among the signals, or in a unit that is none of it.
    """
    count = samples.time.size
    if count == 0:
        return np.zeros((0, len(joints), len(COLUMNS)))
    # numbers of rows stand in for times, which are not yet in order; a recording has two at least
    pad = {key: np.resize(values, max(count, 2)) for key, values in samples.signals.items()}
    recording = Recording(
        "live", np.arange(max(count, 2), dtype=float), pad, Path(samples.source), units=samples.units
    )
    recording = with_commands(rig, recording)
    found = np.full((count, len(joints), len(COLUMNS)), np.nan)
    for place, joint in enumerate(joints):
        key = f"{joint}.command"
        require(recording, [key], units={key: "V"})
        found[:, place, 0] = recording.signal(key)[:count]
        found[:, place, 1] = measured_position(rig, joint, recording)[:count]
        for column, quantity in enumerate(PULLED[1:], start=2):
            name = f"{joint}.{quantity}"
            if name in recording.signals and rig.is_hydraulic(joint):
                found[:, place, column] = recording.signal(name)[:count]
    found[~np.isfinite(found)] = np.nan
    return found


def refuse_driven(rig: Rig) -> None:
    """Refuse a rig that recorded signals drive.

    Raises:
        InputError: it is one.
    """
    if rig.driven_by:
        raise InputError(
            f"rig {rig.name} is driven by recorded signals, which an observer cannot follow; take 'driven_by' out of "
            "its 'recording' section"
        )
