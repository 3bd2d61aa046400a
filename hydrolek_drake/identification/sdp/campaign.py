"""Step tests of a whole joint: simulated on a rig, or out of recordings; and written as recordings."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from hydrolek_drake.errors import InputError
from hydrolek_drake.identification.sdp.identify import SdpIdentification, identify_sdp
from hydrolek_drake.identification.sdp.machine import Machine
from hydrolek_drake.identification.sdp.step_test import StepTest, campaign_data, step_tests_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.recordings.writing import write_signals
from hydrolek_drake.rigs import Rig


def simulated_joint(
    rig: Rig, joint: str, rng: np.random.Generator, moving: bool = False, fine: bool = False
) -> tuple[Machine, list[StepTest], SdpIdentification]:
    """Run the campaign of section 6.1.1 on a rig's joint and identify it.

    Raises:
        InputError: no such joint, or one that cannot be identified.
    """
    machine = Machine(rig, joint)
    tests = machine.campaign(rng, moving, fine)
    limit = rig.value(f"joints.{joint}.command.limit")
    return machine, tests, identify_sdp(joint, tests, *machine.range_deg, limit)


def recorded_joints(
    recordings: Sequence[Recording], joints: Sequence[str] | None, rig: Rig | None
) -> Iterator[SdpIdentification]:
    """Identify every joint that has step tests in the recordings.

    Args:
        recordings: each with one step or many.
        joints: only these; None for all that have a command.
        rig: gives the joints' ranges and voltage limits; without it the extremes of the recordings count.

    Raises:
        InputError: a joint is missing, never steps, or cannot be identified.
    """
    present = sorted({key.split(".")[0] for r in recordings for key in r.signals if key.endswith(".command")})
    if not present:
        raise InputError("identify sdp: no recording has a command, such as right_j2.command_V")
    for joint in joints or present:
        if joint not in present:
            raise InputError(
                f"identify sdp: no recording has a command of {joint}; there are {', '.join(present)}"
            )
        sample = float(campaign_data()["sample"]["value"])
        own = [recording for recording in recordings if f"{joint}.command" in recording.signals]
        tests = [test for recording in own for test in step_tests_of(recording, joint, sample)]
        if not tests:
            raise InputError(f"identify sdp: {joint}: no step to a held voltage other than 0 V")
        if rig is not None and joint in rig.joints:
            low, high = Machine(rig, joint).range_deg
            limit = rig.value(f"joints.{joint}.command.limit")
        else:
            low = min(float(np.nanmin(test.angle_deg)) for test in tests)
            high = max(float(np.nanmax(test.angle_deg)) for test in tests)
            limit = max(abs(test.level_V) for test in tests)
        yield identify_sdp(joint, tests, low, high, limit)


def write_campaign(tests: Sequence[StepTest], joint: str, folder: Path) -> list[Path]:
    """One CSV file for each step test, which `hydrolek identify sdp` reads again."""
    into = folder / "step_tests" / joint
    into.mkdir(parents=True, exist_ok=True)
    return [
        write_signals(
            into / f"from_{test.before_V:+g}_to_{test.level_V:+g}_V.csv",
            np.arange(len(test.voltage_V)) * test.sample,
            {f"{joint}.command": test.voltage_V, f"{joint}.angle": np.radians(test.angle_deg)},
        )
        for test in tests
    ]
