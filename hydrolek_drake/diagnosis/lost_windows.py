"""Windows in which a command may have got lost: what each would have done, and which of them explain most.

While a command is lost a joint misses a piece of its way, and the rest of an open-loop recording is off by that. What a
short window would do is simulated at every place of a recording, and those are picked one after the other that explain
most, as in orthogonal matching pursuit (Pati, Rezaiifar, Krishnaprasad, 27th Asilomar Conference on Signals, Systems
and Computers, 1993).
"""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from hydrolek_drake.diagnosis.score import Across
from hydrolek_drake.diagnosis.workbench import Workbench
from hydrolek_drake.identification.experiment import Experiment

WINDOW_S = 0.1
"""Length of the windows that are tried, side by side."""

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
class Found:
    """Windows of each recording that explain most, and by how much the squared residuals would fall."""

    windows: dict[str, Windows]
    promised: float


def found_in(
    bench: Workbench,
    experiments: Sequence[Experiment],
    beside: Mapping[str, Windows],
    records: np.ndarray,
    step: float,
    neutral: float,
    across: Across | None,
    off: np.ndarray,
) -> Found:
    """Windows that explain most of what is left beside those that are known, and by how much residuals would fall."""

    def left_of(experiment: Experiment, windows: Windows) -> np.ndarray:
        arrived = experiment.without_command(windows, neutral)
        return experiment.residuals(arrived.simulate(records, step).signals)

    here = [left_of(e, beside[recording_of(e)]) for e in experiments]
    ends = np.cumsum([0, *(part.size for part in here)])
    size = ends[-1] + off.size
    tried = [
        (i, begin)
        for i, e in enumerate(experiments)
        for begin in _driven(e, beside[recording_of(e)], neutral)
    ]

    def column(item: tuple[int, float]) -> np.ndarray:
        bench.alive()
        i, begin = item
        experiment = experiments[i]
        windows = in_order(beside[recording_of(experiment)], np.array([[begin, begin + WINDOW_S]]))
        moved = np.zeros(size)
        moved[ends[i] : ends[i + 1]] = np.nan_to_num(left_of(experiment, windows) - here[i])
        return moved if across is None else across(moved)

    rest = np.concatenate([*here, off])
    rest = rest if across is None else across(rest)
    windows = {recording_of(e): NONE for e in experiments}
    if not tried:
        return Found(windows, 0.0)
    columns = np.stack(bench.side_by_side(column, tried), axis=1)
    chosen, amplitudes, promised = picked(columns, rest)
    for i, experiment in enumerate(experiments):
        own = [(tried[k][1], a) for k, a in zip(chosen, amplitudes, strict=True) if tried[k][0] == i]
        windows[recording_of(experiment)] = merged(sorted(own))
    return Found(windows, promised)


def picked(columns: np.ndarray, rest: np.ndarray) -> tuple[list[int], np.ndarray, float]:
    """Columns that explain most, one after the other, their multiples, and the fall of the squared residuals.

    Args:
        columns: change of the residuals by each window. # (values, k)
        rest: residuals. # (values,)
    """
    squares = np.maximum(np.sum(columns**2, axis=0), np.finfo(float).tiny)
    chosen: list[int] = []
    multiples, left = np.zeros(0), rest
    while len(chosen) < columns.shape[1]:
        along = -(columns.T @ left)
        lost = np.clip(along / squares, 0.0, WHOLE)
        gains = lost * (2.0 * along - lost * squares)
        gains[chosen] = 0.0
        best = int(gains.argmax())
        if gains[best] < GAIN * max(float(left @ left) / left.size, 1.0):
            break
        chosen.append(best)
        multiples = lsq_linear(columns[:, chosen], -rest, (0.0, WHOLE)).x
        left = rest + columns[:, chosen] @ multiples
    return chosen, multiples, float(rest @ rest - left @ left)


def merged(windows: Sequence[tuple[float, float]]) -> Windows:
    """Windows that touch are one, as long as all of them together by their multiples and about the same middle.

    Args:
        windows: begin [s] and multiple of each, increasing.
    """
    groups: list[list[tuple[float, float]]] = []
    for begin, multiple in windows:
        if groups and begin - groups[-1][-1][0] < 1.5 * WINDOW_S:
            groups[-1].append((begin, multiple))
        else:
            groups.append([(begin, multiple)])
    found = []
    for group in groups:
        begins, weights = np.array(group).T
        length = min(WINDOW_S * float(weights.sum()), LONGEST_S)
        if length < SHORTEST_S:
            continue
        middle = float(begins @ weights / weights.sum()) + 0.5 * WINDOW_S
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
