"""Set-point sequences of chapters 6 and 7: step, sine and grasp."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from hydrolek_drake.control.laws.law import Array
from hydrolek_drake.errors import InputError
from hydrolek_drake.yaml_files import package_yaml

NAMES = ("step", "sine", "grasp")


@cache
def sequence_data() -> dict[str, Any]:
    """Content of `sequences.yaml`."""
    return package_yaml(__package__, "sequences.yaml")


@dataclass(frozen=True)
class SetPoints:
    """A sequence for several joints.

    Attributes:
        name: step, sine or grasp.
        joints: as asked for.
        start_deg: where the joints rest at first, shape (joints,).
        values_deg: one row per control sample, shape (n, joints).
        first_step: rows during which the first step is answered; empty for the sine.
    """

    name: str
    joints: tuple[str, ...]
    start_deg: Array
    values_deg: Array
    first_step: slice


def arm_and_number(joint: str) -> tuple[str, str]:
    """Arm ("" on the thesis's models) and number of a joint; "j4_linear" is another model of joint 4."""
    arm, _, number = joint.removesuffix("_linear").rpartition("_")
    return arm, number


def set_points(name: str, joints: Sequence[str], sample_s: float, *, machine: bool) -> SetPoints:
    """A sequence by name.

    Args:
        name: of `NAMES`.
        joints: "j1" ... "j5", "j4_linear", or with the arm, "left_j1".
        sample_s: control sample [s].
        machine: the form for the full machine: shorter holds, and sines about a working posture.

    Raises:
        InputError: no such sequence or joint.
    """
    if name not in NAMES:
        raise InputError(f"no sequence '{name}'; choose {', '.join(NAMES)}")
    data = sequence_data()[name]

    def rows(key: str) -> Array:
        values = []
        for joint in joints:
            arm, number = arm_and_number(joint)
            if number not in data[key]:
                raise InputError(f"sequence {name} has no joint '{joint}'; choose {', '.join(data[key])}")
            sign = -1.0 if arm == "left" and number in sequence_data()["mirrored"] else 1.0
            values.append(sign * float(data[key][number]))
        return np.array(values)

    if name == "sine":
        start = rows("from_machine" if machine else "from")
        count = round(float(data["duration"]["value"]) / sample_s)
        cycles = np.array([float(data["cycles"][arm_and_number(joint)[1]]) for joint in joints])
        phase = 2.0 * np.pi * np.outer(np.arange(count) / count, cycles)
        return SetPoints(name, tuple(joints), start, start + rows("amplitude") * np.sin(phase), slice(0, 0))
    hold = data["hold_machine"] if machine and "hold_machine" in data else data["hold"]
    count = round(float(hold["value"]) / sample_s)
    start = rows("from")
    first, second = (rows("to"), start) if name == "step" else (rows("before"), rows("target"))
    values = np.vstack([np.tile(first, (count, 1)), np.tile(second, (count, 1))])
    return SetPoints(name, tuple(joints), start, values, slice(0, count))
