"""What a recording cannot tell, for want of motion or of signals."""

import math

import numpy as np

from hydrolek_drake.checking.complaint import Complaint
from hydrolek_drake.checking.speeds import speed_of
from hydrolek_drake.recordings import Recording
from hydrolek_drake.replay.readings import position_key
from hydrolek_drake.rigs import Rig

REVERSALS = 4
"""Changes of direction without which friction and play are not told from anything else."""

SHARE_OF_COMMAND = 0.05
"""Of the limit: a command below tells neither speeds nor saturation."""

SHARE_OF_TRAVEL = 0.05
"""Of the way between the stops: a motion below tells no geometry."""


def not_told(
    rig: Rig, joint: str, recording: Recording, volts: np.ndarray, position: np.ndarray
) -> list[Complaint]:
    """What the recording cannot tell, for want of motion."""
    found = []
    limit = rig.value(f"joints.{joint}.command.limit")
    centred = volts - rig.value(f"joints.{joint}.command.neutral")
    speed = speed_of(recording.time, position)
    moving = speed[np.abs(speed) > 0.05 * np.nanmax(np.abs(speed))]
    turns = int(np.count_nonzero(np.diff(np.sign(moving))))
    if turns < REVERSALS:
        found.append(
            Complaint(
                position_key(rig, joint),
                f"reverses {turns} times: friction, play and leakage cannot be told apart; record "
                f"{REVERSALS} reversals",
                "",
                wrong=False,
            )
        )
    if rig.needs_command(joint) and float(np.nanmax(np.abs(centred))) < SHARE_OF_COMMAND * limit:
        found.append(
            Complaint(
                f"{joint}.command",
                f"stays below {100 * SHARE_OF_COMMAND:g} % of its limit: full openings of the valve and the pump "
                "cannot be determined",
                "",
                wrong=False,
            )
        )
    way = rig.value(f"joints.{joint}.load.upper_stop") - rig.value(f"joints.{joint}.load.lower_stop")
    moved = float(np.nanmax(position) - np.nanmin(position))
    if math.isfinite(way) and moved < SHARE_OF_TRAVEL * way:
        found.append(
            Complaint(
                position_key(rig, joint),
                f"moves over {100 * moved / way:.2g} % of the way between the stops: geometry and stops cannot be "
                "determined",
                "",
                wrong=False,
            )
        )
    hydraulic = rig.is_hydraulic(joint)
    if hydraulic and f"{joint}.pressure_a" not in recording.signals:
        found.append(
            Complaint(
                f"{joint}.pressure_a",
                "was not recorded: friction and load can be estimated from the motion alone, less surely",
                "",
                wrong=False,
            )
        )
    return found
