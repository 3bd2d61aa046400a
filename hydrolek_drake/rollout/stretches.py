"""Steps that end exactly where the delayed command changes."""

import math
from typing import Any, NamedTuple

import numpy as np

from hydrolek_drake.compiling import njit


@njit
def arrived(command_values: np.ndarray, held: int, joint: Any) -> float:
    """The command that acts [V]; neutral until the first one has arrived, as in the Diagram's transport delay."""
    return command_values[held] if held >= 0 else joint.command.neutral


class Stretch(NamedTuple):
    """Time over which one command acts, in equal steps."""

    until: float  # [s]
    held: int  # place of the command that acts
    volts: float  # that command [V]
    steps: int
    h: float  # their length [s]; 0 for none


@njit
def next_stretch(
    t: float,
    target: float,
    held: int,
    delay: float,
    command_times: np.ndarray,
    command_values: np.ndarray,
    longest_step: float,
    joint: Any,
) -> Stretch:
    """From `t` on as far as the command stays the same, at most to `target`.

    Args:
        t: [s].
        target: [s].
        held: place of the command that has acted, -1 for none.
        delay: of the commands [s].
        command_times: [s], shape (m,).
        command_values: [V], shape (m,).
        longest_step: [s].
        joint: parameter record.
    """
    last = len(command_times) - 1
    while held < last and command_times[held + 1] + delay <= t + 1e-12:
        held += 1
    following = held + 1
    while held >= 0 and following <= last and command_values[following] == command_values[held]:
        following += 1
    until = target
    if following <= last and command_times[following] + delay < target:
        until = max(command_times[following] + delay, t)
    steps = max(math.ceil((until - t) / longest_step - 1e-9), 1)
    return Stretch(until, held, arrived(command_values, held, joint), steps, (until - t) / steps)
