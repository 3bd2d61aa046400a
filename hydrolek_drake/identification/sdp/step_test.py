"""One open-loop step test: its data, the part that can be used, and how tests are found in a recording."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.recordings import Recording, require
from hydrolek_drake.yaml_files import package_yaml


@cache
def campaign_data() -> dict[str, Any]:
    """Content of `campaign.yaml`."""
    return package_yaml(__package__, "campaign.yaml")


@dataclass(frozen=True)
class StepTest:
    """Voltage and angle at uniform samples; the voltage changes once.

    Attributes:
        sample: [s].
        voltage_V: # (n,)
        angle_deg: # (n,)
        step: first sample with the new voltage.
    """

    sample: float
    voltage_V: np.ndarray
    angle_deg: np.ndarray
    step: int

    @property
    def before_V(self) -> float:
        """Voltage before the step."""
        return float(self.voltage_V[0])

    @property
    def level_V(self) -> float:
        """Voltage after the step."""
        return float(self.voltage_V[-1])

    def away_from_ends(self, lower_deg: float, upper_deg: float, margin_deg: float) -> "StepTest":
        """The test up to where the joint comes near the end that it moves to."""
        towards_upper = self.level_V > 0.0
        near = (
            self.angle_deg > upper_deg - margin_deg
            if towards_upper
            else self.angle_deg < lower_deg + margin_deg
        )
        places = np.flatnonzero(near)
        end = int(places[0]) if places.size else len(near)
        return StepTest(self.sample, self.voltage_V[:end], self.angle_deg[:end], self.step)


def step_tests_of(recording: Recording, joint: str, sample: float) -> list[StepTest]:
    """The steps in a recording: a voltage that is held, and then another one that is held.

    Args:
        recording: of one step or of many, one after the other.
        joint: whose `command` [V] and `angle` are taken.
        sample: interval to which the recording is resampled [s].

    Raises:
        InputError: command or angle are missing, or the command never changes.
    """
    command, angle = f"{joint}.command", f"{joint}.angle"
    for key in (command, angle):
        if key not in recording.signals:
            raise InputError(f"{recording.source}: no signal {key}; a step test needs command and angle")
    require(recording, [], complete=[command, angle], units={command: "V"})
    time = np.arange(recording.time[0], recording.time[-1] + 0.5 * sample, sample)
    held = np.searchsorted(recording.time, time + 1e-6 * sample, side="right") - 1
    voltage = recording.signals[command][np.clip(held, 0, None)]
    reading = np.degrees(np.interp(time, recording.time, recording.signals[angle]))
    changes = np.flatnonzero(np.diff(voltage) != 0.0) + 1
    if not changes.size:
        raise InputError(
            f"{recording.source}: {command} is constant at {voltage[0]:g} V, so nothing can be identified"
        )
    edges = [0, *changes.tolist(), len(time)]
    tests = []
    for begin, step, end in zip(edges[:-2], edges[1:-1], edges[2:], strict=True):
        if step - begin > 2 and end - step > 2 and voltage[step] != 0.0:
            tests.append(StepTest(sample, voltage[begin:end], reading[begin:end], step - begin))
    return tests
