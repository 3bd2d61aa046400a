"""A command that is held from each of its times to the next, with parts that did not arrive."""

import numpy as np


def without_windows(
    times: np.ndarray, command: np.ndarray, windows: np.ndarray, neutral: float
) -> tuple[np.ndarray, np.ndarray]:
    """The command as it arrived where parts of it got lost.

    Args:
        times: from which each value is held [s]. # (m,)
        command: the values [V]. # (m,)
        windows: begin and end of each part [s]; one without length changes nothing. # (k, 2)
        neutral: command that acts meanwhile [V].

    Returns:
        Times and values.
    """
    for begin, end in windows.tolist():
        before, after = np.searchsorted(times, (begin, end), side="left")
        resumed = np.searchsorted(times, end, side="right") - 1
        if resumed < 0 or not begin < end:  # it ends before the first command, or with its own begin
            continue
        after = max(after, resumed + 1)
        times = np.concatenate([times[:before], [begin, end], times[after:]])
        command = np.concatenate([command[:before], [neutral, command[resumed]], command[after:]])
    return times, command
