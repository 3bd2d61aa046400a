"""Windows in which a command may have got lost: what each would have done, and which of them explain most.

While a command is lost a joint misses a piece of its way, and the rest of an open-loop recording is off by that. What a
short window would do is simulated at every place of a recording, and those are picked one after the other that explain
most, as in orthogonal matching pursuit (Pati, Rezaiifar, Krishnaprasad, 27th Asilomar Conference on Signals, Systems
and Computers, 1993).
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import lsq_linear

from hydrolek_drake.diagnosis.fitting.projection import Across
from hydrolek_drake.diagnosis.structures.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment

WINDOW_S = 0.1
"""Length of the windows that are tried, side by side."""

SHORTER = 5
"""Where windows promise most, and beside them, so many times shorter ones are tried too: what a joint that rings does
after one lost sample of a controller is not what it does after ten."""

CLOSER = 8
"""At so many places."""

LONGEST_S = 5.0 * WINDOW_S
"""A command that is lost for longer is a recording of two pieces."""

SHORTEST_S = 0.01 * WINDOW_S
"""Two steps of the integration. A joint at full speed that misses its command for a few of them is off by more than
its noise from then on, but shorter ones are no time that a rollout resolves."""

TOUCHING_S = 0.1 * WINDOW_S
"""Windows that are fitted and lie no farther apart than about one sample of a controller are one."""

MOST_SHARE = 0.1
"""So much of a recording may be lost at most: a line that loses more is not in use."""

GAIN = 25.0
"""Fall of the squared residuals, over what is left of each value on average, that a window must promise: five standard
deviations, since hundreds are tried."""

WHOLE = 1.0
"""Multiple of what a window does that is lost as a whole: there is no more in it to be lost. What would ask for more is
something else, or lies beside it."""

Windows = np.ndarray
"""Begin and end of each [s], increasing. # (k, 2)"""

NONE: Windows = np.zeros((0, 2))


def recording_of(experiment: Experiment) -> str:
    """What tells a recording from others, which may have its name or its commands; blocks of it are the same one."""
    digest = hashlib.blake2b(experiment.command.tobytes(), digest_size=8)
    digest.update(experiment.channels[0].measured.tobytes())
    return digest.hexdigest()


@dataclass(frozen=True)
class Window:
    """A window that is tried.

    Attributes:
        experiment: number of the recording.
        begin: [s].
        length: [s].
    """

    experiment: int
    begin: float
    length: float


def found_in(
    bench: Workbench,
    experiments: Sequence[Experiment],
    beside: Mapping[str, Windows],
    records: np.ndarray,
    step: float,
    neutral: float,
    across: Across | None,
    off: np.ndarray,
) -> dict[str, Windows]:
    """Recording -> windows that explain most of what is left beside those that are known."""

    def left_of(experiment: Experiment, windows: Windows) -> np.ndarray:
        arrived = experiment.without_command(windows, neutral)
        return experiment.residuals(arrived.simulate(records, step).signals)

    here = [left_of(e, beside[recording_of(e)]) for e in experiments]
    ends = np.cumsum([0, *(part.size for part in here)])
    size = ends[-1] + off.size
    tried = [
        Window(i, begin, WINDOW_S)
        for i, e in enumerate(experiments)
        for begin in _driven(e, beside[recording_of(e)], neutral)
    ]

    def column(window: Window) -> np.ndarray:
        bench.alive()
        i, experiment = window.experiment, experiments[window.experiment]
        lost = np.array([[window.begin, window.begin + window.length]])
        windows = in_order(beside[recording_of(experiment)], lost)
        moved = np.zeros(size)
        moved[ends[i] : ends[i + 1]] = np.nan_to_num(left_of(experiment, windows) - here[i])
        return moved if across is None else across(moved)

    rest = np.concatenate([*here, off])
    rest = rest if across is None else across(rest)
    windows = {recording_of(e): NONE for e in experiments}
    if not tried:
        return windows
    columns = np.stack(bench.side_by_side(column, tried), axis=1)
    shorter = within(tried, _gains(columns, rest))
    if shorter:
        tried += shorter
        columns = np.concatenate([columns, np.stack(bench.side_by_side(column, shorter), axis=1)], axis=1)
    chosen, amplitudes = picked(columns, rest)
    for i, experiment in enumerate(experiments):
        own = [
            (tried[k].begin, tried[k].length, float(a))
            for k, a in zip(chosen, amplitudes, strict=True)
            if tried[k].experiment == i
        ]
        windows[recording_of(experiment)] = merged(sorted(own))
    return windows


def within(tried: Sequence[Window], gains: np.ndarray) -> list[Window]:
    """Shorter windows within those that promise most, and within those on either side of them.

    Args:
        tried: windows side by side.
        gains: what each promises. # (windows,)
    """
    most = [k for k in np.argsort(-gains)[:CLOSER].tolist() if gains[k] > 0.0]
    near = sorted({k + side for k in most for side in (-1, 0, 1)} & set(range(len(tried))))
    length = WINDOW_S / SHORTER
    return [
        replace(tried[k], begin=tried[k].begin + part * length, length=length)
        for k in near
        for part in range(SHORTER)
    ]


def picked(columns: np.ndarray, rest: np.ndarray) -> tuple[list[int], np.ndarray]:
    """Columns that explain most, one after the other, and their multiples.

    Args:
        columns: change of the residuals by each window. # (values, k)
        rest: residuals. # (values,)
    """
    chosen: list[int] = []
    multiples, left = np.zeros(0), rest
    while len(chosen) < columns.shape[1]:
        gains = _gains(columns, left)
        gains[chosen] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAIN * max(float(left @ left) / left.size, 1.0):
            break
        chosen.append(best)
        multiples = lsq_linear(columns[:, chosen], -rest, (0.0, WHOLE)).x
        left = rest + columns[:, chosen] @ multiples
    return chosen, multiples


def _gains(columns: np.ndarray, left: np.ndarray) -> np.ndarray:
    """Fall of the squared residuals that each column promises alone, by its best multiple from 0 to `WHOLE`."""
    squares = np.maximum(np.sum(columns**2, axis=0), np.finfo(float).tiny)
    along = -(columns.T @ left)
    lost = np.clip(along / squares, 0.0, WHOLE)
    return np.asarray(lost * (2.0 * along - lost * squares))


def merged(windows: Sequence[tuple[float, float, float]]) -> Windows:
    """Windows that touch are one, as long as all of them together by their multiples and about the same middle.

    Args:
        windows: begin [s], length [s] and multiple of each, increasing.
    """
    groups: list[list[tuple[float, float, float]]] = []
    for each in windows:
        if groups and each[0] - sum(groups[-1][-1][:2]) < 0.5 * WINDOW_S:
            groups[-1].append(each)
        else:
            groups.append([each])
    found = []
    for group in groups:
        begins, lengths, multiples = np.array(group).T
        weights = lengths * multiples
        length = min(float(weights.sum()), LONGEST_S)
        if length < SHORTEST_S:
            continue
        middle = float((begins + 0.5 * lengths) @ weights / weights.sum())
        found.append((middle - 0.5 * length, middle + 0.5 * length))
    return np.array(found).reshape(-1, 2)


def _driven(experiment: Experiment, beside: Windows, neutral: float) -> list[float]:
    """Begins of windows in which there is a command to be lost, and which no known one meets."""
    begins = np.arange(experiment.time[0], experiment.time[-1] - WINDOW_S, WINDOW_S)
    times, command = experiment.command_times, experiment.command
    first = np.maximum(np.searchsorted(times, begins, side="right") - 1, 0)
    after = np.searchsorted(times, begins + WINDOW_S, side="left")
    driven = [bool(np.any(command[i:j] != neutral)) for i, j in zip(first, after, strict=True)]
    free = [not np.any((beside[:, 0] < b + WINDOW_S) & (beside[:, 1] > b)) for b in begins]
    return [float(b) for b, d, f in zip(begins, driven, free, strict=True) if d and f]


def in_order(some: Windows, more: Windows) -> Windows:
    """All of them by their begins. # (k, 2)."""
    both = np.concatenate([some, more])
    return both[np.argsort(both[:, 0])]


def joined(windows: Windows) -> Windows:
    """The same time in windows that do not touch, in their order."""
    apart: list[list[float]] = []
    for begin, end in windows[np.argsort(windows[:, 0])].tolist():
        if apart and begin < apart[-1][1] + TOUCHING_S:
            apart[-1][1] = max(apart[-1][1], end)
        else:
            apart.append([begin, end])
    return np.array(apart).reshape(-1, 2)


def too_much(windows: Windows, experiment: Experiment) -> bool:
    """Whether more of a recording would be lost than `MOST_SHARE`."""
    return bool(np.diff(windows, axis=1).sum() > MOST_SHARE * np.ptp(experiment.time))
